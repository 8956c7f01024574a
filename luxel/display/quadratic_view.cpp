#include "luxel/display/quadratic_view.h"

#include <optional>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr int kViewTile = 16;  ///< pixels along a tile's side: its rays fit in a core's cache

/// The triangles as a scene of one mesh, so that a hit's triangle is ours.
scene::Scene scene_of(const QuadraticMesh& mesh) {
  scene::Scene scene;
  scene.materials.resize(2);
  scene.materials[1].double_sided = true;
  scene::Mesh out;
  out.positions = mesh.vertices, out.triangles = mesh.triangles;
  for (const uint8_t two_sided : mesh.two_sided) out.triangle_material.push_back(two_sided ? 1 : 0);
  scene.meshes.push_back(std::move(out));
  scene.instances.push_back({"triangles", 0, {}});
  scene.background = mesh.background, scene.environment = mesh.environment;
  return scene;
}

Rgb value_of(const std::array<Rgb, 6>& r, Barycentric at) {
  return (r[0] * at.u + r[1] * at.v + r[2]) * at.u + (r[3] * at.v + r[4]) * at.v + r[5];
}

}  // namespace

struct QuadraticView::Impl {
  QuadraticMesh mesh;
  scene::Scene scene;  ///< the tracer refers to it
  std::optional<trace::RayTracer> tracer;

  Rgb radiance_of(const trace::Hit& hit, Vec3 direction) const {
    if (!hit.found()) return scene::smooth_surroundings_towards(scene, direction);
    const Rgb e = max(Rgb{}, value_of(mesh.irradiance[hit.triangle], hit.at));
    return mesh.emission[hit.triangle] + mesh.reflectance[hit.triangle] * e * (1 / kPi);
  }
};

QuadraticView::QuadraticView(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
QuadraticView::QuadraticView(QuadraticView&&) noexcept = default;
QuadraticView& QuadraticView::operator=(QuadraticView&&) noexcept = default;
QuadraticView::~QuadraticView() = default;

Result<QuadraticView> QuadraticView::make(QuadraticMesh mesh) {
  const size_t count = mesh.triangles.size();
  LUXEL_CHECK(mesh.irradiance.size() == count && mesh.reflectance.size() == count &&
              mesh.emission.size() == count && mesh.two_sided.size() == count);
  if (count == 0) return fail(ErrorCode::bad_input, "there is no surface to draw");
  auto impl = std::make_unique<Impl>();
  impl->mesh = std::move(mesh);
  impl->scene = scene_of(impl->mesh);
  LUXEL_TRY(impl->tracer, trace::RayTracer::build(impl->scene));
  return QuadraticView(std::move(impl));
}

image::Image QuadraticView::draw(const scene::Camera& camera, int width, int height) const {
  LUXEL_CHECK(width > 0 && height > 0);
  const trace::CameraRays rays_of(camera, width, height);
  image::Image picture(width, height, 4);
  // By tiles, so that neighbouring rays are traced together.
  const int across = (width + kViewTile - 1) / kViewTile,
            down = (height + kViewTile - 1) / kViewTile;
  parallel_for(size_t(across) * size_t(down), 4, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays;
    for (size_t tile = begin; tile < end; ++tile) {
      const int x0 = int(tile) % across * kViewTile, y0 = int(tile) / across * kViewTile;
      const int x1 = std::min(x0 + kViewTile, width), y1 = std::min(y0 + kViewTile, height);
      // A ray through the middle of each pixel.
      rays.clear();
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
          rays.push_back(rays_of.through(float(x) + 0.5f, float(y) + 0.5f));
      const std::vector<trace::Hit> hits = trace::visible_hits(impl_->scene, *impl_->tracer, rays);
      // What they meet is the colour.
      size_t k = 0;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x, ++k) {
          const Rgb c = impl_->radiance_of(hits[k], rays[k].direction);
          float* pixel = picture.at(x, y);
          pixel[0] = c.x, pixel[1] = c.y, pixel[2] = c.z, pixel[3] = hits[k].found() ? 1.0f : 0.0f;
        }
    }
  });
  return picture;
}

}  // namespace luxel::display
