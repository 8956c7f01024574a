#include "luxel/display/normals_view.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "luxel/display/lines.h"
#include "luxel/display/local_light.h"

namespace luxel::display {
namespace {

constexpr float kLengthOfDiagonal = 0.04f;
constexpr size_t kMostTriangles = 100000;
constexpr Rgb kRed{0.85f, 0.02f, 0.02f};

struct NormalLine {
  Vec3 from, normal;
  float length_m = 0;
};

/// True where draw_seen would show this triangle's side.
bool is_seen(const scene::Scene& scene, const scene::SurfacePoint& p, Vec3 position,
             const Viewer& viewer) {
  return material_at(scene, p).double_sided ||
         dot(front_normal(scene, p.instance, p.triangle), viewer.from(position)) > 0;
}

/// Lines no longer than the triangle's longest edge: fine meshes keep their shape under them.
void add_lines(const scene::Scene& scene, uint32_t instance, uint32_t triangle,
               const Viewer& viewer, float most_m, std::vector<NormalLine>& lines) {
  constexpr std::array<Barycentric, 3> at{{{0, 0}, {1, 0}, {0, 1}}};
  const scene::Triangle3 t = world_triangle(scene, instance, triangle);
  const float edge = std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)});
  for (const Barycentric corner : at) {
    const scene::SurfacePoint p{instance, triangle, corner};
    const Vec3 from = world_position(scene, p);
    if (is_seen(scene, p, from, viewer))
      lines.push_back({from, shading_normal(scene, p), std::min(most_m, edge)});
  }
}

/// The normals of the corners of visible sides, of each place and direction the longest line.
std::vector<NormalLine> normal_lines(const scene::Scene& scene, const Viewer& viewer,
                                     float most_m) {
  const size_t triangles = scene::first_triangles(scene).back();
  const size_t nth = std::max<size_t>(1, (triangles + kMostTriangles - 1) / kMostTriangles);
  std::vector<NormalLine> lines;
  size_t number = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      if (number++ % nth == 0) add_lines(scene, i, t, viewer, most_m, lines);
  const auto place = [](const NormalLine& l) {
    return std::tuple(l.from.x, l.from.y, l.from.z, l.normal.x, l.normal.y, l.normal.z);
  };
  std::sort(lines.begin(), lines.end(), [&](const NormalLine& a, const NormalLine& b) {
    return std::pair(place(a), -a.length_m) < std::pair(place(b), -b.length_m);
  });
  const auto repeated =
      std::unique(lines.begin(), lines.end(),
                  [&](const NormalLine& a, const NormalLine& b) { return place(a) == place(b); });
  lines.erase(repeated, lines.end());
  return lines;
}

}  // namespace

std::vector<Line> lines_of_normals(const scene::Scene& scene, const scene::Camera& camera) {
  std::vector<Line> out;
  for (const NormalLine& l :
       normal_lines(scene, Viewer(camera), kLengthOfDiagonal * world_bounds(scene).diagonal()))
    out.push_back({l.from, l.from + l.normal * l.length_m, kRed});
  return out;
}

Result<image::Image> draw_normals(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  const scene::Camera& camera, const DrawParams& params,
                                  Progress& progress) {
  const Viewer viewer(camera);
  const auto grey_at = [&](const trace::Hit& hit) {
    const Vec3 to_viewer = viewer.from(world_position(scene, hit.point()));
    const float facing = std::abs(dot(shading_normal(scene, hit.point()), to_viewer));
    return Rgb{1, 1, 1} * (0.15f + 0.55f * facing);
  };
  LUXEL_TRY(image::Image picture, draw_seen(scene, tracer, camera, grey_at, params, progress));
  const std::vector<Line> lines = lines_of_normals(scene, camera);
  const image::Image drawn =
      draw_lines(scene, tracer, camera, params.width, params.height, lines, progress);
  progress.finish();
  LUXEL_TRY_STATUS(stopped(progress));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float s = drawn.at(x, y)[3];
      picture.set_rgb(x, y, picture.rgb(x, y) * (1 - s) + drawn.rgb(x, y) * s);
      picture.at(x, y)[3] = std::max(picture.at(x, y)[3], s);
    }
  return picture;
}

}  // namespace luxel::display
