#include "luxel/display/lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "luxel/base/parallel.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {
namespace {

constexpr float kStep = 0.5f;  ///< between the points of a line [pixels]

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
  Rgb color;
  trace::Ray ray;
};

/// The part of a line in the picture as dots, and at most the picture's own size in dots: a corner
/// right beside the camera makes no endless line.
void add_dots(const trace::CameraRays& camera, const Line& line, std::vector<Dot>& dots) {
  const auto a = place_of(camera, line.from), b = place_of(camera, line.to);
  if (!a || !b) return;
  const float most = 2 * (camera.width + camera.height) / kStep;
  const int count = 1 + int(std::min(length(*b - *a) / kStep, most));
  for (int i = 0; i <= count; ++i) {
    const Vec3 point = line.from + (line.to - line.from) * (float(i) / float(count));
    const auto place = place_of(camera, point);
    if (!place || place->x < -1 || place->y < -1 || place->x > camera.width + 1 ||
        place->y > camera.height + 1)
      continue;
    const trace::Ray through = camera.through(place->x, place->y);
    const float distance = dot(point - through.origin, through.direction);
    // A line may lie on a surface: what is as near to it as that does not hide it.
    dots.push_back(
        {*place, line.color, {through.origin, 0, through.direction, distance * (1 - 1e-3f)}});
  }
}

/// Spreads a dot over the four pixels around it; a pixel keeps its largest share.
void splat(const Dot& dot, image::Image& picture) {
  const float x = dot.place.x - 0.5f, y = dot.place.y - 0.5f;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int px = x0 + i, py = y0 + j;
      if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
      const float weight = (1 - std::abs(x - float(px))) * (1 - std::abs(y - float(py)));
      const float share = std::min(1.0f, 1.5f * weight);
      if (share <= picture.at(px, py)[3]) continue;
      picture.set_rgb(px, py, dot.color);
      picture.at(px, py)[3] = share;
    }
}

}  // namespace

image::Image draw_lines(const scene::Scene& scene, const trace::RayTracer& tracer,
                        const scene::Camera& viewer, int width, int height,
                        std::span<const Line> lines, Progress& progress) {
  constexpr size_t kAtOnce = 4096;  ///< lines: bounds the memory of their dots
  const trace::CameraRays camera(viewer, width, height);
  image::Image picture(width, height, 4);
  progress.begin("draw lines", lines.size());
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
      if (!hidden[i]) splat(dots[i], picture);
    progress.advance(end - begin);
  }
  return picture;
}

}  // namespace luxel::display
