// Stated errors against true ones, on random scenes.
#include <fmt/format.h>

#include <array>
#include <map>

#include "bench/validation.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/pipeline/command/probe.h"
#include "luxel/pipeline/command/relight_error.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/solve/matrix/trials.h"
#include "luxel/validate/random_scenes.h"
#include "luxel/validate/stated_errors.h"
#include "luxel/viewfactor/random_contacts.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/visible_form_factor.h"

namespace luxel::bench {
namespace {

using validate::Claim;

/// What one statement says and what is true, one entry per scene.
struct Account {
  Claim claim = Claim::bound;
  std::vector<validate::Compared> compared;
  std::vector<uint64_t> seed;  ///< of its scene
};
using Accounts = std::map<std::string, Account>;

constexpr int kScenes = 100, kResolution = 32, kPathsEach = 1024, kShadowRays = 16;
constexpr int kSamples = 64, kReferencePaths = 256;
constexpr double kMaxError = 0.05;
/// Two million paths in the last: enough for a point of a millionth of the mean light.
constexpr int kProbeRounds = 10;
constexpr std::array<std::string_view, 5> kStatedSolvers{"gather", "reference", "hemicube",
                                                         "matrix", "hierarchical"};
constexpr const char *kProbe = "probe", *kRelight = "relight", *kFactors = "factors";

/// An entry of the scene of this seed.
struct Entry {
  Claim claim = Claim::bound;
  uint64_t seed = 0;
  validate::Compared compared{};
};

void add_entry(Accounts& accounts, const std::string& name, const Entry& entry) {
  Account& account = accounts[name];
  account.claim = entry.claim;
  account.compared.push_back(entry.compared), account.seed.push_back(entry.seed);
}

/// A scene that is ready, and the judge's light of it.
struct JudgedScene {
  const validate::Prepared& scene;
  const validate::Judged& judged;
  uint64_t seed = 1;
  std::string lamp{};  ///< RandomScene::lamp

  double mean_light() const {
    double sum = 0, count = 0;
    for (size_t i = 0; i < judged.first.size(); ++i)
      if (!judged.hidden[i]) sum += double(luminance(judged.mean(i))), count += 1;
    return count > 0 ? sum / count : 0;
  }
  double area_m2() const {
    double sum = 0;
    const scene::Scene& s = scene.scene;
    for (uint32_t i = 0; i < s.instances.size(); ++i)
      for (uint32_t t = 0; t < s.meshes[s.instances[i].mesh].triangles.size(); ++t)
        sum += scene::area_m2(scene::world_triangle(s, i, t));
    return sum;
  }
};

/// Settings of every solver that let a scene take about a second of one core.
pipeline::BakeSettings small_settings(const JudgedScene& s, std::string_view solver) {
  pipeline::BakeSettings out;
  out.samples = solver == "reference" ? kReferencePaths : kSamples;
  out.direct_samples = kShadowRays, out.seed = 7;
  auto& hemicube = out.own.of<hemicube::HemicubeParams>();
  hemicube.resolution = 64, hemicube.max_elements = 500;
  auto& matrix = out.own.of<matrix::MatrixParams>();
  matrix.patches.count = 1024, matrix.factors.rays_per_patch = 512;
  auto& hierarchical = out.own.of<pipeline::HierarchicalSettings>();
  hierarchical.solve.eps = float(0.03 * s.mean_light());
  hierarchical.solve.min_area_m2 = float(s.area_m2() / 300);
  hierarchical.mesh.discontinuity.max_per_leaf = 2;
  return out;
}

/// How a solver's RMS is meant: what rays measure is stated with one standard error more.
Claim claim_of(std::string_view solver) {
  const bool is_measured = solver == "matrix" || solver == "hemicube" || solver == "hierarchical";
  return is_measured ? Claim::bound : Claim::estimate;
}

Status add_solver(const JudgedScene& s, std::string_view solver, double max_error,
                  Accounts& accounts, Progress& progress) {
  pipeline::BakeSettings settings = small_settings(s, solver);
  settings.max_error = float(max_error);
  LUXEL_TRY(const validate::Timed solved, validate::solve(s.scene, solver, settings, progress));
  const validate::StatedError e = validate::stated_error(solved.light, s.judged);
  const std::string name =
      std::string(solver) + (max_error > 0 ? fmt::format(" --max-error {}", max_error) : "");
  add_entry(accounts, name + ", RMS over mean",
            {claim_of(solver), s.seed, {e.stated, e.truth, e.truth_low, e.truth_high}});
  if (e.stated_p95 > 0)
    add_entry(accounts, name + ", 95 % of texels err by less",
              {Claim::bound, s.seed, {e.stated_p95, e.true_p95}});
  // What was asked for is a statement, too, where nobody warns that it was not reached.
  if (max_error > 0 && e.stated_p95 <= max_error)
    add_entry(accounts, name + ", where it is reached",
              {Claim::bound, s.seed, {max_error, e.true_p95}});
  return {};
}

/// `luxel probe` at some texel's place. The truth: 64 times 2,048 paths from there.
Status add_probe(const JudgedScene& s, Accounts& accounts, Progress& progress) {
  const transport::Elements& elements = s.scene.elements;
  size_t i = hash64(s.seed, 0x9b0be) % elements.size();
  while (s.judged.hidden[i]) i = (i + 1) % elements.size();
  pipeline::ProbeSettings settings;
  settings.at = elements.position[i], settings.normal = elements.normal[i], settings.in_air = true;
  settings.max_error = 0.02, settings.time_budget_s = 1e6, settings.most_rounds = kProbeRounds;
  LUXEL_TRY(const pipeline::Probed probed,
            pipeline::probe_by_paths(settings, s.scene.scene, {}, progress));
  constexpr size_t kStreams = 64;
  const std::vector<Vec3> at(kStreams, elements.position[i]), normal(kStreams, elements.normal[i]);
  LUXEL_TRY(const reference::TexelPaths paths,
            reference::irradiance_by_paths(s.scene.scene, {at, normal, normal}, *s.scene.tracer,
                                           {2048, -1, hash64(s.seed, 0x7247e)}, progress));
  double sum = 0, sum2 = 0;
  for (const Rgb& e : paths.irradiance) sum += double(luminance(e)) / kStreams;
  for (const Rgb& e : paths.irradiance) sum2 += std::pow(double(luminance(e)) - sum, 2);
  const double off = double(luminance(probed.irradiance)) - sum;
  const double noise2 = sum2 / (kStreams * (kStreams - 1));
  add_entry(
      accounts, "probe, twice the standard error",
      {Claim::bound,
       s.seed,
       {2 * double(probed.luminance_error), std::sqrt(std::max(0.0, off * off - 4 * noise2))}});
  return {};
}

/// Whether a point lies in a room, this far from all surfaces.
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

/// What the file of `luxel relight` holds, small; its places are relit_places().
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
    LUXEL_TRY_STATUS(pipeline::measure_relight_error(scene, *s.scene.tracer, checked.own, s.seed,
                                                     data, progress));
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

/// What the codec loses of light, over all patches: the same matrix without a codec is the truth.
/// What all of the relighter errs by: the path tracer is.
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

/// Whether these rows are asked for: all, or those of one solver or command.
bool is_asked_for(const StatedParams& params, std::string_view what) {
  return params.only.empty() || params.only == what;
}

/// Every solver, the relighter and the probe on every scene.
Status add_scenes(const StatedParams& params, Accounts& accounts, Progress& progress) {
  for (uint64_t seed = params.first_seed; seed < params.first_seed + kScenes; ++seed) {
    validate::RandomScene random = validate::random_scene(seed);
    LUXEL_TRY(const auto p, validate::prepare(std::move(random.scene), kResolution, progress));
    LUXEL_TRY(const validate::Judged judged, validate::judge(*p, kPathsEach, 1, progress));
    const JudgedScene s{*p, judged, seed, random.lamp};
    for (const std::string_view solver : kStatedSolvers)
      if (is_asked_for(params, solver))
        LUXEL_TRY_STATUS(add_solver(s, solver, 0, accounts, progress));
    if (is_asked_for(params, "gather"))
      LUXEL_TRY_STATUS(add_solver(s, "gather", kMaxError, accounts, progress));
    if (is_asked_for(params, kProbe)) LUXEL_TRY_STATUS(add_probe(s, accounts, progress));
    if (is_asked_for(params, kRelight)) LUXEL_TRY_STATUS(add_relight(s, accounts, progress));
  }
  return {};
}

/// Every method of `luxel factors` on polygons with blockers close to them.
Status add_factors(const StatedParams& params, Accounts& accounts, Progress& progress) {
  if (!is_asked_for(params, kFactors)) return {};
  uint64_t index = 0;
  for (int i = 0; i < kScenes; ++i) {
    LUXEL_TRY_STATUS(stopped(progress));
    const viewfactor::Contact c = viewfactor::random_contact(1233 + params.first_seed, index);
    const double exact = c.exact / viewfactor::area_m2(c.a);
    const viewfactor::FormFactor f = viewfactor::form_factor(c.a, c.b, c.blockers, 1e-4);
    add_entry(accounts, "factors, analytic",
              {Claim::bound, uint64_t(i), {f.error, std::abs(f.value - exact)}});
    for (const bool hemicube : {false, true}) {
      const viewfactor::SampledParams sampling{.samples = hemicube ? 64u : 1u << 14,
                                               .hemicube = hemicube ? 64 : 0};
      LUXEL_TRY(const viewfactor::SampledFactor sampled,
                viewfactor::sampled_form_factor(c.a, c.b, c.blockers, sampling));
      add_entry(accounts,
                hemicube ? "factors, hemicube, twice the standard error"
                         : "factors, rays, twice the standard error",
                {Claim::bound, uint64_t(i), {2 * sampled.error, std::abs(sampled.value - exact)}});
    }
  }
  return {};
}

std::vector<double> values(const Account& account, double validate::Compared::*member) {
  std::vector<double> out;
  for (const validate::Compared& c : account.compared) out.push_back(c.*member);
  return out;
}

std::string introduction(uint64_t first_seed) {
  return fmt::format(
      "## Stated errors against true ones\n\n"
      "{} random scenes, of seeds from {} on: closed rooms of 1 to 10 m and rooms under a sky. "
      "They "
      "hold plates and walls of a ten-thousandth to a hundredth of the room, slivers, and boxes. "
      "Lamps are tiny or huge. Factors: blockers that touch a polygon or nearly do; the truth is "
      "in closed form.\n\n"
      "- A *bound* holds where the truth is no larger. An *estimate* holds where the truth is "
      "within a factor of {} of it, either way.\n"
      "- *scenes*: those in which an error is stated. *holds*: in so many of them it does. *true "
      "over stated*: median and 95th percentile over the scenes.\n"
      "- Errors of texels are relative to their own light, or to a tenth of the mean where they "
      "are darker. RMS is over the mean light.\n"
      "- Bakes have {} x {} texels. gather: {} rays and {} shadow rays; reference: {} paths; "
      "hemicube: {} elements of {} pixels; matrix: 1,024 patches of 512 rays; hierarchical: an eps "
      "of 3 % of the mean light, and at most 300 of the smallest elements.\n"
      "- The truth of bakes is the path tracer at the texels' sample points, twice {} paths each. "
      "Its noise is taken out: an RMS counts as false if 1.96 standard errors of the paths do not "
      "explain it.\n"
      "- *where it is reached*: scenes in which no warning says that --max-error was not.\n"
      "- probe states one standard error, at most; twice that is held against {} more paths. "
      "`luxel lux` "
      "and `luxel probe --from` state the standard error of their own rays. `luxel render` states "
      "that of its paths, as reference does.\n"
      "- relight has 512 patches of 2,048 rays. It states what its codec loses of indirect light; "
      "the truth is the same matrix without a codec. It states the RMS of all of indirect light "
      "over its mean, for the scene's lights and for point lights; the truth is the path tracer. A "
      "light that comes later stands no closer to a surface than a patch is wide.\n"
      "- `luxel compare` states no error.\n\n",
      kScenes, first_seed, validate::kEstimateFactor, kResolution, kResolution, kSamples,
      kShadowRays, kReferencePaths, 500, 64, kPathsEach, 64 * 2048);
}

}  // namespace

std::vector<std::string> stated_error_names() {
  std::vector<std::string> names(kStatedSolvers.begin(), kStatedSolvers.end());
  names.insert(names.end(), {kProbe, kRelight, kFactors});
  return names;
}

Result<Section> validate_stated_errors(const StatedParams& params, Progress& progress) {
  Accounts accounts;
  LUXEL_TRY_STATUS(add_scenes(params, accounts, progress));
  LUXEL_TRY_STATUS(add_factors(params, accounts, progress));
  Section section;
  section.json = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, account] : accounts) {
    const validate::Held h = validate::held(account.claim, account.compared);
    if (h.scenes == 0) continue;
    const char* claim = account.claim == Claim::bound ? "bound" : "estimate";
    rows.push_back({name, claim, std::to_string(h.scenes), std::to_string(h.holds),
                    fmt::format("{:.2g}", h.middle_ratio), fmt::format("{:.2g}", h.p95_ratio)});
    section.json.push_back({{"error", name},
                            {"claim", claim},
                            {"scenes", h.scenes},
                            {"holds", h.holds},
                            {"median_ratio", h.middle_ratio},
                            {"p95_ratio", h.p95_ratio},
                            {"seeds", account.seed},
                            {"stated", values(account, &validate::Compared::stated)},
                            {"true", values(account, &validate::Compared::truth)}});
  }
  section.markdown = introduction(params.first_seed) +
                     markdown_table({"stated error", "claim", "scenes", "holds",
                                     "true over stated, median", "95th percentile"},
                                    rows);
  return section;
}

}  // namespace luxel::bench
