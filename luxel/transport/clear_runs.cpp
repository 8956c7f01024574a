#include "luxel/transport/clear_runs.h"

#include <algorithm>
#include <optional>

#include "luxel/base/vec2_double.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/facet.h"

namespace luxel::transport {
namespace {

/// A run's triangle and what lies around it is asked once: long runs share the cost, and short ones
/// keep away from what stands on the surface.
constexpr uint32_t kShortest = 8, kLongest = 64;

/// A run and the texels around it, on the plane of their triangle.
struct OnPlane {
  Vec3 normal;
  std::array<Vec3, 4> corners;
  float step_m = 0;  ///< the longer side of a texel
};

/// Nothing where the triangle has no area in the atlas.
std::optional<OnPlane> on_plane(const scene::Scene& scene, const atlas::Atlas& atlas,
                                const atlas::TexelMap& map, TexelRun run) {
  const atlas::Texel& first = map.texels[run.first];
  const auto& c = atlas.corners[first.triangle_number];
  const DVec2 e1 = to_double(c[1]) - to_double(c[0]), e2 = to_double(c[2]) - to_double(c[0]);
  const double area2 = cross(e1, e2);
  if (area2 == 0) return {};
  const scene::Facet facet = scene::facet_of(scene, first.sample.instance, first.sample.triangle);
  const DVec3 a = to_double(facet.corners.a), ab = to_double(facet.corners.b) - a,
              ac = to_double(facet.corners.c) - a;
  // A texel to the right, and a texel down [m].
  const DVec3 right = (ab * e2.y - ac * e1.y) * (1 / area2);
  const DVec3 down = (ac * e1.x - ab * e2.x) * (1 / area2);
  const auto place = [&](double x, double y) {
    return to_float(a + right * (x - double(c[0].x)) + down * (y - double(c[0].y)));
  };
  const double x0 = double(first.x) - 1, x1 = double(first.x) + double(run.count) + 1;
  const double y0 = double(first.y) - 1, y1 = double(first.y) + 2;
  return OnPlane{facet.front,
                 {place(x0, y0), place(x1, y0), place(x0, y1), place(x1, y1)},
                 float(std::max(length(right), length(down)))};
}

/// The box above it. `around_m` beyond its corners, from one height to the other.
trace::TurnedBox box_above(const OnPlane& run, float around_m, float from_m, float to_m) {
  const Vec3 along = normalize(run.corners[1] - run.corners[0]);
  const Vec3 across = cross(run.normal, along);
  const Vec3 origin = run.corners[0];
  Vec2 low{0, 0}, high{0, 0};
  for (const Vec3 corner : run.corners) {
    const float u = dot(corner - origin, along), v = dot(corner - origin, across);
    low = {std::min(low.x, u), std::min(low.y, v)},
    high = {std::max(high.x, u), std::max(high.y, v)};
  }
  const Vec2 middle = (low + high) * 0.5f, half = (high - low) * 0.5f;
  return {origin + along * middle.x + across * middle.y + run.normal * (0.5f * (from_m + to_m)),
          {along, across, run.normal},
          {half.x + around_m, half.y + around_m, 0.5f * (to_m - from_m)}};
}

}  // namespace

TexelRun run_from(const atlas::TexelMap& map, uint32_t first, uint32_t most) {
  const atlas::Texel& begin = map.texels[first];
  const uint32_t limit = std::min({most, kLongest, uint32_t(map.texels.size()) - first});
  uint32_t count = 1;
  while (count < limit) {
    const atlas::Texel& next = map.texels[first + count];
    if (next.triangle_number != begin.triangle_number || next.y != begin.y ||
        next.x != begin.x + count)
      break;
    ++count;
  }
  return {first, count};
}

bool is_clear(const scene::Scene& scene, const atlas::Atlas& atlas, const atlas::TexelMap& map,
              const trace::RayTracer& tracer, TexelRun run, const Clearance& clearance) {
  if (run.count < kShortest) return false;
  const std::optional<OnPlane> plane = on_plane(scene, atlas, map, run);
  if (!plane || !(plane->step_m > 0)) return false;
  const atlas::Texel& first = map.texels[run.first];
  const uint32_t instance = first.sample.instance, triangle = first.sample.triangle;
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  const uint32_t behind = mesh.other_side.empty() ? scene::kNone : mesh.other_side[triangle];
  const auto counts = [&](uint32_t other_instance, uint32_t other) {
    if (other_instance == instance && (other == triangle || other == behind)) return false;
    return clearance.own_chart || atlas.chart[atlas.triangle_number(other_instance, other)] !=
                                      atlas.chart[first.triangle_number];
  };
  return tracer.is_empty(box_above(*plane, clearance.around_steps * plane->step_m, clearance.from_m,
                                   clearance.to_steps * plane->step_m),
                         counts);
}

}  // namespace luxel::transport
