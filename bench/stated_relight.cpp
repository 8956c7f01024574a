// Stated errors of `luxel relight` against true ones.
#include <cmath>

#include "bench/stated_accounts.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/pipeline/command/relight_error.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/solve/matrix/trials.h"

namespace luxel::bench {
namespace {

using validate::Claim;

/// A point lies in a room, this far from all surfaces.
bool is_free(const JudgedScene& s, Vec3 place, float clearance_m) {
  constexpr uint32_t kAround = 256;
  uint32_t met = 0;
  for (uint32_t k = 0; k < kAround; ++k) {
    const Vec3 d = uniform_sphere_sample(sobol_owen_2d(k, s.seed));
    const trace::Hit hit = s.scene.tracer->closest_hit({place, 0, d, INFINITY});
    if (hit.t < clearance_m || (hit.found() && hit.back_face)) return false;
    met += hit.found();
  }
  return met > kAround / 2;
}

/// A point light somewhere in a scene, no closer to a surface than a patch is wide; none where
/// there is no such place.
std::vector<scene::PunctualLight> later_lamp(const JudgedScene& s,
                                             const matrix::RelightData& data) {
  constexpr uint64_t kTries = 1000;
  const Box3 box = scene::world_bounds(s.scene.scene);
  const Vec3 size = box.upper - box.lower;
  const float clearance_m = matrix::side_of_patches(data.area_m2);
  for (uint64_t k = 0; k < kTries; ++k) {
    const auto part = [&](uint64_t axis) {
      return float(double(hash64(hash64(s.seed, 0x1a3b), 3 * k + axis) >> 11) * 0x1p-53);
    };
    scene::PunctualLight lamp;
    lamp.position = box.lower + Vec3{part(0), part(1), part(2)} * size;
    if (is_free(s, lamp.position, clearance_m)) return {lamp};
  }
  return {};
}

/// Light by which the relighter is judged; what the scene has not was not there when it was made.
struct RelitBy {
  std::string name;
  std::vector<scene::PunctualLight> lamps;
  std::vector<Rgb> emission;  ///< empty: the scene's
  Rgb background{};
};

RelitBy own_light(const JudgedScene& s) {
  const bool glows = s.lamp == "tiny" || s.lamp == "huge";
  return {glows ? "of glowing squares" : "of point lights and skies",
          s.scene.scene.lights,
          {},
          s.scene.scene.background};
}
RelitBy later_point_light(const JudgedScene& s, const matrix::RelightData& data) {
  return {"of a point light that comes later",
          later_lamp(s, data),
          std::vector<Rgb>(s.scene.scene.materials.size()),
          {}};
}
RelitBy later_glow(const JudgedScene& s, const matrix::RelightData& data) {
  RelitBy out{"of a material that glows later", {}, {}, {}};
  out.emission.resize(data.material_name.size());
  out.emission[data.material[hash64(s.seed, 0x6105) % data.size()]] = {1, 1, 1};
  return out;
}

/// Places of a scene at which the relighter is judged.
transport::Elements relit_places(const JudgedScene& s) {
  return pipeline::places_to_check(s.scene.scene, hash64(s.seed, 0x91ace));
}

/// A small file of `luxel relight`; its places are relit_places().
Result<matrix::RelightData> small_relight(const JudgedScene& s, matrix::CodecKind codec,
                                          Progress& progress) {
  const scene::Scene& scene = s.scene.scene;
  matrix::RelightParams params;
  params.patches.count = 512, params.factors.rays_per_patch = 2048, params.codec = codec;
  const pipeline::CheckedTarget own = pipeline::with_places({}, relit_places(s));
  pipeline::CheckedTarget checked =
      pipeline::with_places(own.target, pipeline::places_to_check(scene, s.seed));
  LUXEL_TRY(matrix::RelightData data,
            matrix::make_relight_data(scene, *s.scene.tracer, std::move(checked.target), params,
                                      progress));
  if (codec == matrix::CodecKind::hierarchical)
    LUXEL_TRY_STATUS(pipeline::measure_relight_error(scene, *s.scene.tracer, checked.own,
                                                     params.factors.rays_per_patch, s.seed, data,
                                                     progress));
  return data;
}

/// Root mean square over the patches, by area, and relative to that of the truth.
double lost_by_codec(std::span<const Rgb> got, std::span<const Rgb> truth,
                     std::span<const float> area_m2) {
  double off = 0, all = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    const Rgb d = got[i] - truth[i];
    off += double(area_m2[i]) * double(dot(d, d));
    all += double(area_m2[i]) * double(dot(truth[i], truth[i]));
  }
  return all > 0 ? std::sqrt(off / all) : 0;
}

/// The path tracer's word on indirect light at the places: root mean square error over the mean.
Result<double> relit_error(const JudgedScene& s, const RelitBy& by, std::span<const Rgb> got,
                           Progress& progress) {
  scene::Scene lit = s.scene.scene, direct = lit;
  lit.lights = by.lamps, lit.background = by.background;
  for (size_t m = 0; m < by.emission.size(); ++m) lit.materials[m].emission = by.emission[m];
  direct.lights = by.lamps, direct.background = {};
  for (scene::Material& m : direct.materials) m.emission = {};
  const transport::Elements places = relit_places(s);
  const reference::Receivers at = reference::receivers(places);
  LUXEL_TRY(const validate::Judged judged,
            validate::judge(lit, *s.scene.tracer, at, kPathsEach, 1, progress));
  // Point lights have no size: one path finds their direct light.
  LUXEL_TRY(const reference::TexelPaths straight,
            reference::irradiance_by_paths(direct, at, *s.scene.tracer, {1, 0, 1}, progress));
  double off = 0, light = 0, count = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    if (judged.hidden[i]) continue;
    const Rgb a = judged.first[i] - straight.irradiance[i],
              b = judged.second[i] - straight.irradiance[i];
    off += double(luminance(got[i] - a)) * double(luminance(got[i] - b));
    light += 0.5 * double(luminance(a + b)), count += 1;
  }
  return light > 0 ? std::sqrt(std::max(0.0, off / count)) * count / light : 0;
}

}  // namespace

Status add_relight(const JudgedScene& s, Accounts& accounts, Progress& progress) {
  std::vector<matrix::Relighter> relighters;
  for (const auto codec : {matrix::CodecKind::hierarchical, matrix::CodecKind::dense32}) {
    LUXEL_TRY(matrix::RelightData data, small_relight(s, codec, progress));
    LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(data), {}));
    relighters.push_back(std::move(relighter));
  }
  const matrix::RelightData& data = relighters[0].data();
  for (const RelitBy& by : {own_light(s), later_point_light(s, data), later_glow(s, data)}) {
    for (matrix::Relighter& r : relighters) r.update({by.lamps, by.emission, by.background});
    const matrix::Relit& got = relighters[0].latest();
    const double lost = lost_by_codec(got.indirect, relighters[1].latest().indirect, data.area_m2);
    if (lost > 0)
      add_entry(accounts, "relight, what the codec loses " + by.name,
                {Claim::bound, s.seed, {data.codec_error, lost}});
    if (by.lamps.empty() && !by.emission.empty()) continue;  // nothing is stated
    LUXEL_TRY(const double off, relit_error(s, by, got.indirect_at_points, progress));
    if (off > 0)
      add_entry(
          accounts, "relight, RMS over mean " + by.name,
          {Claim::bound, s.seed, {by.emission.empty() ? data.baked_error : data.lamp_error, off}});
  }
  return {};
}

}  // namespace luxel::bench
