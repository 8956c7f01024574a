#include "luxel/pipeline/texels/wrong_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/surface_points.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {
namespace {

constexpr size_t kSidePoints = 1024, kPointsOfMean = 256;
constexpr int kSidePaths = 64, kPathsOfMean = 16;
/// Points between two looks at whether the work was cancelled.
constexpr size_t kPointsAtOnce = 64;
constexpr uint64_t kPointSeed = 0x7369646573;
/// An eye overlooks differences below these: of the brighter side, and of the scene's mean.
constexpr float kSameShare = 0.25f, kDarkShare = 0.1f;
constexpr float kStandardErrors = 2;
/// Light of this share of the other side's is none.
constexpr float kNoLightBehind = 1e-3f;
/// Eyes that look back at a point, and directions downwards that each looks in.
constexpr uint32_t kEyes = 8, kLooks = 32;
/// Shares: fronts among the surfaces below an eye where somebody may stand; surfaces among all that
/// it looks at; and eyes that are there among those of a point that shows.
constexpr double kFewestFronts = 0.25, kFewestSurfaces = 0.25, kFewestEyes = 0.25;
/// The largest distance of an eye from its point, relative to the scene's diagonal.
constexpr float kFarEye = 0.25f;

/// The light of one side at a point.
struct SideLight {
  float luminance = 0, error = 0;  ///< of E, and its standard error [W/m^2]
  bool seen = false;               ///< it does not lie within a solid
};

/// Points that stand for so much of the layout each.
struct Spread {
  std::vector<scene::SurfacePoint> points;
  double share_each = 0;
};

double uv_area(const scene::Mesh& mesh, uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return 0.5 * std::abs(double(cross(mesh.uv1[b] - mesh.uv1[a], mesh.uv1[c] - mesh.uv1[a])));
}

/// Spreads points over the open triangles, in proportion to their shares of the layout.
Spread spread_over(const scene::Scene& scene, const std::vector<std::vector<uint8_t>>& open) {
  struct Part {
    scene::SurfacePoint triangle;
    double surface, uv;
  };
  std::vector<Part> parts;
  double surface = 0, uv = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const uint32_t m = scene.instances[i].mesh;
    for (uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const Part part{{i, t, {}},
                      double(area_m2(scene::world_triangle(scene, i, t))),
                      uv_area(scene.meshes[m], t)};
      surface += part.surface, uv += part.uv;
      if (!open[m].empty() && open[m][t]) parts.push_back(part);
    }
  }
  std::vector<double> below{0};
  for (const Part& part : parts)
    below.push_back(below.back() + 0.5 * (part.surface / surface + (uv > 0 ? part.uv / uv : 0)));
  Spread out;
  out.share_each = below.back() / kSidePoints;
  RandomStream random{hash64(kPointSeed)};
  for (size_t k = 0; k < kSidePoints; ++k) {
    const double at = (double(k) + double(random.next())) * out.share_each;
    const auto found = std::upper_bound(below.begin() + 1, below.end() - 1, at);
    out.points.push_back(parts[size_t(found - below.begin()) - 1].triangle);
    out.points.back().at = triangle_sample(sobol_owen_2d(uint32_t(k), hash64(kPointSeed)));
  }
  return out;
}

/// Traces the light of the points' fronts (`side` 1) or backs (-1), a few at a time.
Result<std::vector<SideLight>> light_of(const scene::Scene& scene, const trace::RayTracer& tracer,
                                        std::span<const scene::SurfacePoint> points, float side,
                                        reference::PathParams params, Progress& progress) {
  std::vector<SideLight> out;
  for (size_t begin = 0; begin < points.size(); begin += kPointsAtOnce) {
    LUXEL_TRY_STATUS(stopped(progress));
    std::vector<Vec3> position, normal;
    for (const scene::SurfacePoint& p :
         points.subspan(begin, std::min(kPointsAtOnce, points.size() - begin))) {
      normal.push_back(scene::front_normal(scene, p.instance, p.triangle) * side);
      position.push_back(scene::off_surface(scene, p, normal.back()));
    }
    params.seed = hash64(kPointSeed, begin);
    Progress own;  // the path tracer's stage is one of the light, which this is not
    LUXEL_TRY(
        const reference::TexelPaths traced,
        reference::irradiance_by_paths(scene, {position, normal, normal}, tracer, params, own));
    for (size_t k = 0; k < position.size(); ++k) {
      const bool seen = !traced.enclosed[k];
      out.push_back(
          {seen ? luminance(traced.irradiance[k]) : 0, seen ? traced.luminance_error[k] : 0, seen});
    }
    progress.advance(position.size());
  }
  return out;
}

bool differ(const SideLight& front, const SideLight& back, float mean) {
  const float brighter = std::max(front.luminance, back.luminance);
  const float noise = kStandardErrors * std::hypot(front.error, back.error);
  return brighter > kDarkShare * mean &&
         std::abs(front.luminance - back.luminance) - noise > kSameShare * brighter;
}

/// The mean over what is seen of the scene's fronts.
float mean_seen(std::span<const SideLight> light) {
  float sum = 0, count = 0;
  for (const SideLight& l : light)
    if (l.seen) sum += l.luminance, ++count;
  return count > 0 ? sum / count : 0;
}

/// Surfaces below an eye.
struct Below {
  uint32_t fronts = 0, backs = 0;

  /// Fronts, such as those of a floor: beneath a ground there are none, nor outside of a room in
  /// empty space.
  bool is_floor() const { return fronts > 0 && fronts >= kFewestFronts * (fronts + backs); }
  /// Anything: what is wound inside out has backs for floors.
  bool is_something() const { return fronts + backs >= kFewestSurfaces * kLooks; }
};

Below look_down(const trace::RayTracer& tracer, Vec3 eye, uint64_t seed) {
  std::array<trace::Ray, kLooks> rays;
  std::array<trace::Hit, kLooks> hits;
  const auto down = frame_around(Vec3{0, -1, 0});
  for (uint32_t k = 0; k < kLooks; ++k)
    rays[k] = {eye, 0, down.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, seed))), INFINITY};
  tracer.closest_hits(rays, hits);
  Below out;
  for (const trace::Hit& hit : hits)
    if (hit.found()) ++(hit.back_face ? out.backs : out.fronts);
  return out;
}

/// True: the back of a point is seen from places where somebody may stand: over floors, or over
/// anything where its front is black. Eyes are put halfway to the hits of rays from the back, so
/// that nothing is between them and the point.
bool is_looked_at(const scene::Scene& scene, const trace::RayTracer& tracer,
                  const scene::SurfacePoint& p, float diagonal_m, bool front_is_black,
                  uint64_t seed) {
  const Vec3 behind = -scene::front_normal(scene, p.instance, p.triangle);
  const Vec3 from = scene::off_surface(scene, p, behind);
  const auto frame = frame_around(behind);
  uint32_t standing = 0;
  for (uint32_t k = 0; k < kEyes; ++k) {
    const trace::Ray ray{from, 0, frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, seed))),
                         INFINITY};
    const trace::Hit hit = tracer.closest_hit(ray);
    const float away_m = std::min(hit.found() ? 0.5f * hit.t : INFINITY, kFarEye * diagonal_m);
    const Below below = look_down(tracer, from + ray.direction * away_m, hash64(seed, k));
    standing += front_is_black ? below.is_something() : below.is_floor();
  }
  return standing >= kFewestEyes * kEyes;
}

/// The light at the spread points.
struct PointLight {
  std::vector<SideLight> fronts, backs;
  float mean = 0;
  bool is_known = true;

  bool is_wrong(size_t k) const {
    return backs[k].seen && (!is_known || differ(fronts[k], backs[k], mean));
  }
  /// The front lies within something that no light enters.
  bool front_is_black(size_t k) const {
    return is_known ? fronts[k].luminance <= kNoLightBehind * backs[k].luminance : !fronts[k].seen;
  }
};

WrongSides count_wrong(const scene::Scene& scene, const trace::RayTracer& tracer,
                       const Spread& spread, const PointLight& light) {
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<uint8_t> shown(kSidePoints);
  parallel_for(kSidePoints, 16, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      shown[k] = light.is_wrong(k) && is_looked_at(scene, tracer, spread.points[k], diagonal_m,
                                                   light.front_is_black(k), hash64(kPointSeed, k));
  });
  WrongSides out;
  for (size_t k = 0; k < kSidePoints; ++k) {
    if (light.is_wrong(k)) out.all += spread.share_each;
    if (shown[k]) out.shown += spread.share_each;
  }
  return out;
}

}  // namespace

Result<WrongSides> wrong_sides(const scene::Scene& scene,
                               const std::vector<std::vector<uint8_t>>& open, LightIs light_is,
                               Progress& progress) {
  const Spread spread = spread_over(scene, open);
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  progress.begin("light of sides", 2 * kSidePoints + kPointsOfMean);
  // Without light the paths only say which sides are seen.
  PointLight light;
  light.is_known = light_is == LightIs::known;
  const reference::PathParams paths{kSidePaths, light.is_known ? -1 : 0};
  LUXEL_TRY(light.fronts, light_of(scene, tracer, spread.points, 1, paths, progress));
  LUXEL_TRY(light.backs, light_of(scene, tracer, spread.points, -1, paths, progress));
  LUXEL_TRY(const std::vector<SideLight> all,
            light_of(scene, tracer, scene::points_uniform_in_area(scene, kPointsOfMean, kPointSeed),
                     1, {kPathsOfMean, paths.bounces}, progress));
  light.mean = mean_seen(all);
  return count_wrong(scene, tracer, spread, light);
}

}  // namespace luxel::pipeline
