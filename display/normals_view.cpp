#include "display/normals_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "base/parallel.h"
#include "display/local_light.h"
#include "trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr float kLengthOfDiagonal = 0.04f;
constexpr size_t kMostTriangles = 100000;
constexpr Rgb kRed{0.85f, 0.02f, 0.02f};
constexpr float kStep = 0.5f;  ///< between the points of a line [pixels]

struct Line {
  Vec3 from, normal;
  float length_m = 0;
  Vec3 to() const { return from + normal * length_m; }
};

/// Whether draw_seen would show this triangle's side.
bool is_seen(const scene::Scene& scene, const scene::SurfacePoint& p, Vec3 position,
             const Viewer& viewer) {
  return material_at(scene, p).double_sided ||
         dot(front_normal(scene, p.instance, p.triangle), viewer.from(position)) > 0;
}

/// Lines no longer than the triangle's longest edge: fine meshes keep their shape under them.
void add_lines(const scene::Scene& scene, uint32_t instance, uint32_t triangle,
               const Viewer& viewer, float most_m, std::vector<Line>& lines) {
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
std::vector<Line> normal_lines(const scene::Scene& scene, const Viewer& viewer, float most_m) {
  const size_t triangles = scene::first_triangles(scene).back();
  const size_t nth = std::max<size_t>(1, (triangles + kMostTriangles - 1) / kMostTriangles);
  std::vector<Line> lines;
  size_t number = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    for (uint32_t t = 0; t < scene.meshes[scene.instances[i].mesh].triangles.size(); ++t)
      if (number++ % nth == 0) add_lines(scene, i, t, viewer, most_m, lines);
  const auto place = [](const Line& l) {
    return std::tuple(l.from.x, l.from.y, l.from.z, l.normal.x, l.normal.y, l.normal.z);
  };
  std::sort(lines.begin(), lines.end(), [&](const Line& a, const Line& b) {
    return std::pair(place(a), -a.length_m) < std::pair(place(b), -b.length_m);
  });
  const auto repeated = std::unique(lines.begin(), lines.end(), [&](const Line& a, const Line& b) {
    return place(a) == place(b);
  });
  lines.erase(repeated, lines.end());
  return lines;
}

/// The inverse of CameraRays::through: where a point of the world is in the picture; none for what
/// lies behind a perspective camera.
std::optional<Vec2> place_of(const trace::CameraRays& camera, Vec3 point) {
  Vec3 v = point - camera.eye;
  if (!camera.orthographic) {
    const float depth = dot(v, camera.forward);
    if (depth <= 1e-6f * length(v)) return std::nullopt;
    v = v / depth;
  }
  const float x = dot(v, camera.right) / dot(camera.right, camera.right);
  const float y = dot(v, camera.up) / dot(camera.up, camera.up);
  return Vec2{0.5f * (x + 1) * camera.width, 0.5f * (1 - y) * camera.height};
}

/// A point of a line: where it is in the picture, and the ray from the viewer that ends there.
struct Dot {
  Vec2 place;
  trace::Ray ray;
};

/// The part of a line in the picture as dots, and at most the picture's own size in dots: a corner
/// right beside the camera makes no endless line.
void add_dots(const trace::CameraRays& camera, const Line& line, std::vector<Dot>& dots) {
  const auto a = place_of(camera, line.from), b = place_of(camera, line.to());
  if (!a || !b) return;
  const float most = 2 * (camera.width + camera.height) / kStep;
  const int count = 1 + int(std::min(length(*b - *a) / kStep, most));
  for (int i = 0; i <= count; ++i) {
    const Vec3 point = line.from + line.normal * (line.length_m * float(i) / float(count));
    const auto place = place_of(camera, point);
    if (!place || place->x < -1 || place->y < -1 || place->x > camera.width + 1 ||
        place->y > camera.height + 1)
      continue;
    const trace::Ray through = camera.through(place->x, place->y);
    const float distance = dot(point - through.origin, through.direction);
    // A line starts on a surface: what lies as near to it as that does not hide it.
    dots.push_back({*place, {through.origin, 0, through.direction, distance * (1 - 1e-3f)}});
  }
}

/// Spreads a dot over the four pixels around it; a pixel keeps its largest share.
void splat(Vec2 place, image::Image& share) {
  const float x = place.x - 0.5f, y = place.y - 0.5f;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int px = x0 + i, py = y0 + j;
      if (px < 0 || py < 0 || px >= share.width || py >= share.height) continue;
      const float weight = (1 - std::abs(x - float(px))) * (1 - std::abs(y - float(py)));
      float& kept = *share.at(px, py);
      kept = std::max(kept, std::min(1.0f, 1.5f * weight));
    }
}

/// How much of each pixel is covered by visible parts of lines; one channel.
image::Image line_shares(const scene::Scene& scene, const trace::RayTracer& tracer,
                         const trace::CameraRays& camera, const std::vector<Line>& lines,
                         Progress& progress) {
  constexpr size_t kAtOnce = 4096;  ///< lines: bounds the memory of their dots
  image::Image share(int(camera.width), int(camera.height), 1);
  for (size_t begin = 0; begin < lines.size() && !progress.cancelled(); begin += kAtOnce) {
    std::vector<Dot> dots;
    const size_t end = std::min(begin + kAtOnce, lines.size());
    for (size_t i = begin; i < end; ++i) add_dots(camera, lines[i], dots);
    std::vector<uint8_t> hidden(dots.size());
    parallel_for(dots.size(), 4096, [&](size_t first, size_t last) {
      std::vector<trace::Ray> rays;
      for (size_t i = first; i < last; ++i) rays.push_back(dots[i].ray);
      const std::vector<trace::Hit> hits = trace::visible_hits(scene, tracer, rays);
      for (size_t i = first; i < last; ++i) hidden[i] = hits[i - first].found() ? 1 : 0;
    });
    for (size_t i = 0; i < dots.size(); ++i)
      if (!hidden[i]) splat(dots[i].place, share);
    progress.advance(end - begin);
  }
  return share;
}

}  // namespace

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
  const std::vector<Line> lines =
      normal_lines(scene, viewer, kLengthOfDiagonal * world_bounds(scene).diagonal());
  progress.begin("draw normals", lines.size());
  const trace::CameraRays rays_of(camera, params.width, params.height);
  const image::Image share = line_shares(scene, tracer, rays_of, lines, progress);
  progress.finish();
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "drawing was stopped");
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float s = *share.at(x, y);
      picture.set_rgb(x, y, picture.rgb(x, y) * (1 - s) + kRed * s);
      picture.at(x, y)[3] = std::max(picture.at(x, y)[3], s);
    }
  return picture;
}

}  // namespace luxel::display
