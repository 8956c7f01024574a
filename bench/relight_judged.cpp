// The relighter's indirect light against the path tracer's.
#include <algorithm>
#include <cmath>

#include "bench/relight.h"
#include "bench/timing.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/pipeline/texels/two_sides.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/validate/agreement.h"

namespace luxel::bench {
namespace {

constexpr uint64_t kSeed = 7;

/// A lamp stands this part of the scene's diagonal or more away from all surfaces, and so many of
/// the rays around it meet surfaces, none their backs. Sides that were added behind double-sided
/// surfaces are backs: on the roof of a house, or inside of its walls, little of a lamp's light
/// comes back, and what is lost of it says nothing.
constexpr float kClear = 0.04f, kMet = 0.6f;

/// The scene in the air of which lamps stand.
struct Air {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  std::span<const size_t> own_triangles;  ///< per mesh: what follows are added sides

  bool is_back(const trace::Hit& hit) const {
    return hit.back_face || hit.triangle >= own_triangles[scene.instances[hit.instance].mesh];
  }
};

std::vector<size_t> triangle_counts(const scene::Scene& scene) {
  std::vector<size_t> out;
  for (const scene::Mesh& mesh : scene.meshes) out.push_back(mesh.triangles.size());
  return out;
}

bool is_in_the_air(const Air& air, Vec3 position, float diagonal_m) {
  constexpr int kAround = 256;
  RandomStream random{kSeed};
  int met = 0;
  for (int k = 0; k < kAround; ++k) {
    const trace::Hit hit =
        air.tracer.closest_hit({position, 0, uniform_sphere_sample(random.next2()), INFINITY});
    if (hit.found() && (air.is_back(hit) || hit.t < kClear * diagonal_m)) return false;
    met += hit.found();
  }
  return float(met) >= kMet * float(kAround);
}

Result<std::vector<Vec3>> positions_in(const Air& air, size_t count) {
  const Box3 box = scene::world_bounds(air.scene);
  const Vec3 size = box.upper - box.lower;
  RandomStream random{kSeed};
  std::vector<Vec3> out;
  for (int tries = 0; out.size() < count; ++tries) {
    if (tries == 100000)
      return fail(ErrorCode::bad_input, "{} has no air for lamps", air.scene.name);
    const Vec3 u{random.next(), random.next(), random.next()};
    const Vec3 position = box.lower + u * size;
    if (is_in_the_air(air, position, length(size))) out.push_back(position);
  }
  return out;
}

/// About `count` of the texels, spread over the map: what the judge's noise hides falls faster with
/// paths per texel than with texels.
matrix::Target take_texels(validate::Prepared& p, size_t count) {
  matrix::Target target;
  target.kind = matrix::Target::Kind::texels;
  target.width = target.height = uint32_t(p.map.resolution);
  transport::Elements taken;
  const size_t step = std::max<size_t>(1, p.elements.size() / count);
  for (size_t i = 0; i < p.elements.size(); i += step) {
    const atlas::Texel& t = p.map.texels[i];
    target.texel.push_back({uint16_t(t.x), uint16_t(t.y)});
    taken.position.push_back(p.elements.position[i]);
    taken.normal.push_back(p.elements.normal[i]);
    taken.geometric_normal.push_back(p.elements.geometric_normal[i]);
    taken.reflectance.push_back(p.elements.reflectance[i]);
  }
  p.elements = std::move(taken);
  target.position = p.elements.position;
  target.normal = p.elements.normal, target.geometric_normal = p.elements.geometric_normal;
  return target;
}

/// The judge's indirect light: its light but what comes straight from the lamp, which one path
/// finds exactly.
Result<validate::Judged> judge_indirect(const validate::Prepared& p, int paths_each,
                                        Progress& progress) {
  LUXEL_TRY(validate::Judged judged, validate::judge(p, paths_each, kSeed, progress));
  LUXEL_TRY(const reference::TexelPaths direct,
            reference::irradiance_by_paths(p.scene, reference::receivers(p.elements), *p.tracer,
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
  out.per_texel = a.relative_rmse, out.bias = a.bias_over_mean;
  return out;
}

}  // namespace

Result<JudgedRelight> judge_relight(std::string name, scene::Scene scene,
                                    const JudgeSettings& settings, Progress& progress) {
  for (scene::Material& material : scene.materials) material.emission = {};
  scene.background = {}, scene.lights = {scene::PunctualLight{}};
  const std::vector<size_t> own_triangles = triangle_counts(scene);
  // One lamp alone lights the scene; some texels are compared.
  LUXEL_TRY(const auto p, validate::prepare(std::move(scene), settings.resolution, progress));
  matrix::Target target = take_texels(*p, settings.texels);
  JudgedRelight out;
  out.scene = std::move(name), out.texels = target.position.size(), out.paths = settings.paths;
  const size_t first_stage = progress.stages().size();
  // Preparation, timed.
  matrix::RelightParams params;
  params.patches.count = settings.patches;
  LUXEL_TRY(params.patches.open_backs, pipeline::open_backs(p->scene, progress));
  params.factors.rays_per_patch = 8192;
  LUXEL_TRY(matrix::RelightData data,
            matrix::make_relight_data(p->scene, *p->tracer, std::move(target), params, progress));
  progress.finish();
  out.stages = stages_from(progress, first_stage);
  out.patches = data.size(), out.codec_error = data.codec_error;
  // The lamp at several places: relit, and by paths.
  LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(data), {}));
  LUXEL_TRY(const std::vector<Vec3> positions,
            positions_in({p->scene, *p->tracer, own_triangles}, settings.lights));
  for (const Vec3 position : positions) {
    p->scene.lights[0].position = position;
    relighter.update({p->scene.lights, {}, {}});
    LUXEL_TRY(const validate::Judged judged, judge_indirect(*p, settings.paths / 2, progress));
    out.lights.push_back(compare(relighter.latest().indirect_at_points, judged));
    out.lights.back().position = position;
  }
  return out;
}

}  // namespace luxel::bench
