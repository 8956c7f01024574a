// The relighter's indirect light against the path tracer's.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "bench/relight.h"
#include "bench/timing.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/pipeline/texels/two_sides.h"
#include "luxel/scene/surface_points.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/transport/elements_at.h"
#include "luxel/validate/agreement.h"

namespace luxel::bench {
namespace {

constexpr uint64_t kSeed = 7;

/// A lamp stands this part of the scene's diagonal or more away from all surfaces, and so many of
/// the rays around it meet surfaces, none their backs, as they do on the roof of a house or inside
/// of its walls: little of a lamp's light comes back there, and what is lost of it says nothing.
constexpr float kClear = 0.04f, kMet = 0.6f;

bool is_in_the_air(const trace::RayTracer& tracer, Vec3 position, float diagonal_m) {
  constexpr int kAround = 256;
  RandomStream random{kSeed};
  int met = 0;
  for (int k = 0; k < kAround; ++k) {
    const trace::Hit hit =
        tracer.closest_hit({position, 0, uniform_sphere_sample(random.next2()), INFINITY});
    if (hit.found() && (hit.back_face || hit.t < kClear * diagonal_m)) return false;
    met += hit.found();
  }
  return float(met) >= kMet * float(kAround);
}

/// Point lights at random in the air of the scene.
Result<std::vector<scene::PunctualLight>> lights_in(const scene::Scene& scene, size_t count) {
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const Box3 box = scene::world_bounds(scene);
  const Vec3 size = box.upper - box.lower;
  RandomStream random{kSeed};
  std::vector<scene::PunctualLight> out;
  for (int tries = 0; out.size() < count; ++tries) {
    if (tries == 100000) return fail(ErrorCode::bad_input, "{} has no air for lamps", scene.name);
    const Vec3 u{random.next(), random.next(), random.next()};
    scene::PunctualLight light;
    light.position = box.lower + u * size;
    if (is_in_the_air(tracer, light.position, length(size))) out.push_back(light);
  }
  return out;
}

/// A scene with sides of their own behind double-sided surfaces, and points of its surfaces.
struct Place {
  scene::Scene scene;
  std::vector<scene::PunctualLight> lights;  ///< the scene's own, one at a time
  std::optional<trace::RayTracer> tracer;
  std::vector<std::vector<uint8_t>> open_backs;
  transport::Elements points;
};

/// Sides and backs are those of `luxel bake`, which looks at the file's own light, or at a day
/// where it has none. That light is taken away then. Points are spread evenly over the area: the
/// texels of a lightmap are not, since each sliver of a triangle has one. What the judge's noise
/// hides falls faster with paths per point than with points.
Result<std::unique_ptr<Place>> make_place(scene::Scene scene, const JudgeSettings& settings,
                                          Progress& progress) {
  auto out = std::make_unique<Place>();
  LUXEL_TRY(out->lights, lights_in(scene, settings.lights));
  LUXEL_TRY_STATUS(pipeline::add_outside_light({}, scene));
  LUXEL_TRY_STATUS(pipeline::split_sides(
      scene, {.uv = atlas::UvMode::unwrap, .light_is = pipeline::LightIs::to_come}, progress));
  LUXEL_TRY(out->open_backs, pipeline::open_backs(scene, progress));
  for (scene::Material& material : scene.materials) material.emission = {};
  scene.background = {}, scene.environment = {}, scene.lights = {};
  out->scene = std::move(scene);
  LUXEL_TRY(out->tracer, trace::RayTracer::build(out->scene));
  out->points = transport::elements_at(
      out->scene, scene::points_uniform_in_area(out->scene, settings.points, kSeed));
  return out;
}

matrix::Target target_of(const transport::Elements& points) {
  matrix::Target out;
  out.kind = matrix::Target::Kind::vertices;
  out.position = copied(points.position);
  out.normal = copied(points.normal);
  out.geometric_normal = copied(points.geometric_normal);
  return out;
}

/// The judge's indirect light: its light but what comes straight from the lamp, which one path
/// finds exactly.
Result<validate::Judged> judge_indirect(const Place& place, int paths_each, Progress& progress) {
  const reference::Receivers receivers = reference::receivers(place.points);
  LUXEL_TRY(validate::Judged judged,
            validate::judge(place.scene, *place.tracer, receivers, paths_each, kSeed, progress));
  LUXEL_TRY(const reference::TexelPaths direct,
            reference::irradiance_by_paths(place.scene, receivers, *place.tracer,
                                           {.samples = 1, .bounces = 0}, progress));
  for (size_t i = 0; i < judged.first.size(); ++i)
    for (std::vector<Rgb>* answer : {&judged.first, &judged.second})
      (*answer)[i] = (*answer)[i] - direct.irradiance[i];
  return judged;
}

/// With two independent answers a and b of the judge, (g - a)(g - b) has the mean of the square of
/// g's error, and a b that of the light. Where g is right, the former's variance is the product of
/// those of a and b, each twice that of their mean, s^2.
JudgedLight compare(std::span<const Rgb> solved, const validate::Judged& judged) {
  double error = 0, light = 0, noise = 0, noise2 = 0;
  for (size_t i = 0; i < solved.size(); ++i) {
    if (judged.hidden[i]) continue;
    const Rgb a = judged.first[i], b = judged.second[i], s = judged.standard_error[i];
    const double s2 = double(dot(s, s));
    error += double(dot(solved[i] - a, solved[i] - b));
    light += double(dot(a, b)), noise += s2, noise2 += 4 * s2 * s2;
  }
  JudgedLight out;
  out.relative = std::sqrt(std::max(0.0, error) / light);
  out.noise = std::sqrt(noise / light);
  out.resolution = std::sqrt(2 * std::sqrt(noise2) / light);
  const validate::Agreement a = validate::agreement(solved, {}, judged);
  out.per_point = a.relative_rmse, out.bias = a.bias_over_mean;
  return out;
}

}  // namespace

Result<JudgedRelight> judge_relight(std::string name, scene::Scene scene,
                                    const JudgeSettings& settings, Progress& progress) {
  LUXEL_TRY(const auto place, make_place(std::move(scene), settings, progress));
  JudgedRelight out;
  out.scene = std::move(name), out.points = place->points.size(), out.paths = settings.paths;
  const size_t first_stage = progress.stages().size();
  // Preparation, timed.
  matrix::RelightParams params;
  params.patches.count = settings.patches;
  params.patches.open_backs = place->open_backs;
  params.factors.rays_per_patch = 8192;
  LUXEL_TRY(matrix::RelightData data,
            matrix::make_relight_data(place->scene, *place->tracer, target_of(place->points),
                                      params, progress));
  progress.finish();
  out.stages = stages_from(progress, first_stage);
  out.patches = data.size(), out.codec_error = data.usual_codec_error;
  out.largest_codec_error = data.codec_error;
  // One light after the other: relit, and by paths.
  LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(data), {}));
  for (const scene::PunctualLight& light : place->lights) {
    place->scene.lights = {light};
    relighter.update({place->scene.lights, {}, {}});
    LUXEL_TRY(const validate::Judged judged, judge_indirect(*place, settings.paths / 2, progress));
    out.lights.push_back(compare(relighter.latest().indirect_at_points, judged));
    out.lights.back().position = light.position;
  }
  return out;
}

}  // namespace luxel::bench
