#include "luxel/display/quadratic_view.h"

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/display/triangle_raster.h"

namespace luxel::display {
namespace {

/// Rows that are filled together: their nearness fits in a core's cache.
constexpr int kBandRows = 16;

Rgb value_of(const std::array<Rgb, 6>& r, Barycentric at) {
  return (r[0] * at.u + r[1] * at.v + r[2]) * at.u + (r[3] * at.v + r[4]) * at.v + r[5];
}

/// Per band of rows, the places of the triangles in it.
std::vector<std::vector<uint32_t>> by_bands(std::span<const PictureTriangle> triangles,
                                            size_t bands) {
  std::vector<std::vector<uint32_t>> out(bands);
  for (uint32_t k = 0; k < triangles.size(); ++k)
    for (int band = triangles[k].first_row / kBandRows;
         band <= (triangles[k].end_row - 1) / kBandRows; ++band)
      out[size_t(band)].push_back(k);
  return out;
}

}  // namespace

struct QuadraticView::Impl {
  QuadraticMesh mesh;
  scene::Scene surroundings;  ///< nothing else

  Rgb radiance_of(uint32_t triangle, Barycentric at) const {
    const Rgb e = max(Rgb{}, value_of(mesh.irradiance[triangle], at));
    return mesh.emission[triangle] + mesh.reflectance[triangle] * e * (1 / kPi);
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
  impl->surroundings.background = impl->mesh.background;
  impl->surroundings.environment = impl->mesh.environment;
  return QuadraticView(std::move(impl));
}

image::Image QuadraticView::draw(const scene::Camera& camera, int width, int height) const {
  LUXEL_CHECK(width > 0 && height > 0);
  const QuadraticMesh& mesh = impl_->mesh;
  const trace::CameraRays rays_of(camera, width, height);
  const std::vector<PictureTriangle> triangles =
      picture_triangles({mesh.vertices, mesh.triangles, mesh.two_sided}, rays_of);
  const auto bands = size_t((height + kBandRows - 1) / kBandRows);
  const std::vector<std::vector<uint32_t>> of_band = by_bands(triangles, bands);
  image::Image picture(width, height, 4);
  parallel_for(bands, 1, [&](size_t begin, size_t end) {
    RasterRows rows;
    rows.width = width;
    for (size_t band = begin; band < end; ++band) {
      // Finds the triangle that each pixel sees.
      rows.first = int(band) * kBandRows, rows.end = std::min(rows.first + kBandRows, height);
      fill(triangles, of_band[band], rays_of.orthographic, rows);
      // Each pixel gets its colour.
      size_t k = 0;
      for (int y = rows.first; y < rows.end; ++y)
        for (int x = 0; x < width; ++x, ++k) {
          const bool is_surface = rows.seen[k] != scene::kNone;
          const float at_x = float(x) + 0.5f, at_y = float(y) + 0.5f;
          Rgb c;
          if (is_surface) {
            const PictureTriangle& t = triangles[rows.seen[k]];
            c = impl_->radiance_of(t.triangle, place_at(t, double(at_x), double(at_y)));
          } else {
            c = scene::smooth_surroundings_towards(impl_->surroundings,
                                                   rays_of.through(at_x, at_y).direction);
          }
          float* pixel = picture.at(x, y);
          pixel[0] = c.x, pixel[1] = c.y, pixel[2] = c.z, pixel[3] = is_surface ? 1.0f : 0.0f;
        }
    }
  });
  return picture;
}

}  // namespace luxel::display
