// Stated errors against true ones, on random scenes.
#include <fmt/format.h>

#include <array>
#include <map>

#include "bench/validation.h"
#include "luxel/base/random.h"
#include "luxel/pipeline/command/probe.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
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
  std::vector<double> stated, truth;
  std::vector<uint64_t> seed;  ///< of its scene
};
using Accounts = std::map<std::string, Account>;

constexpr int kScenes = 100, kResolution = 32, kPathsEach = 512, kShadowRays = 16;
constexpr int kSamples = 64, kReferencePaths = 256;
constexpr double kMaxError = 0.05;
constexpr std::array<std::string_view, 5> kStatedSolvers{"gather", "reference", "hemicube",
                                                         "matrix", "hierarchical"};
constexpr const char *kProbe = "probe", *kRelight = "relight", *kFactors = "factors";

/// An entry of the scene of this seed.
struct Entry {
  Claim claim = Claim::bound;
  uint64_t seed = 0;
  double stated = 0, truth = 0;
};

void add_entry(Accounts& accounts, const std::string& name, const Entry& entry) {
  Account& account = accounts[name];
  account.claim = entry.claim;
  account.stated.push_back(entry.stated), account.truth.push_back(entry.truth);
  account.seed.push_back(entry.seed);
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
  add_entry(accounts, name + ", RMS over mean", {claim_of(solver), s.seed, e.stated, e.truth});
  if (e.stated_p95 > 0)
    add_entry(accounts, name + ", 95 % of texels err by less",
              {Claim::bound, s.seed, e.stated_p95, e.true_p95});
  // What was asked for is a statement, too, where nobody warns that it was not reached.
  if (max_error > 0 && e.stated_p95 <= max_error)
    add_entry(accounts, name + ", where it is reached",
              {Claim::bound, s.seed, max_error, e.true_p95});
  return {};
}

/// `luxel probe` at some texel's place. The truth: 64 times 2,048 paths from there.
Status add_probe(const JudgedScene& s, Accounts& accounts, Progress& progress) {
  const transport::Elements& elements = s.scene.elements;
  size_t i = hash64(s.seed, 0x9b0be) % elements.size();
  while (s.judged.hidden[i]) i = (i + 1) % elements.size();
  pipeline::ProbeSettings settings;
  settings.at = elements.position[i], settings.normal = elements.normal[i], settings.in_air = true;
  settings.max_error = 0.02, settings.time_budget_s = 1e6;
  LUXEL_TRY(const pipeline::Probed probed,
            pipeline::probe_by_paths(settings, s.scene.scene, {}, progress));
  constexpr size_t kStreams = 64;
  const std::vector<Vec3> at(kStreams, elements.position[i]), normal(kStreams, elements.normal[i]);
  LUXEL_TRY(const reference::TexelPaths paths,
            reference::irradiance_by_paths(s.scene.scene, {at, normal, normal}, *s.scene.tracer,
                                           {2048, -1, hash64(s.seed, 1)}, progress));
  double sum = 0, sum2 = 0;
  for (const Rgb& e : paths.irradiance) sum += double(luminance(e)) / kStreams;
  for (const Rgb& e : paths.irradiance) sum2 += std::pow(double(luminance(e)) - sum, 2);
  const double off = double(luminance(probed.irradiance)) - sum;
  const double noise2 = sum2 / (kStreams * (kStreams - 1));
  add_entry(accounts, "probe, twice the standard error",
            {Claim::bound, s.seed, 2 * double(probed.luminance_error),
             std::sqrt(std::max(0.0, off * off - 4 * noise2))});
  return {};
}

/// What the codec of `luxel relight` loses of the scene's own light, over all patches by area: the
/// same matrix without a codec is the truth.
Status add_codec(const JudgedScene& s, Accounts& accounts, Progress& progress) {
  std::vector<Rgb> indirect[2];
  double stated = 0;
  std::vector<float> area_m2;
  for (const bool whole : {false, true}) {
    matrix::RelightParams params;
    params.patches.count = 512, params.factors.rays_per_patch = 2048;
    if (whole) params.codec = matrix::CodecKind::dense32;
    LUXEL_TRY(matrix::RelightData data,
              matrix::make_relight_data(s.scene.scene, *s.scene.tracer, {}, params, progress));
    if (!whole) stated = data.codec_error, area_m2 = data.area_m2;
    LUXEL_TRY(matrix::Relighter relighter, matrix::Relighter::make(std::move(data), {}));
    relighter.update({.punctual = s.scene.scene.lights, .background = s.scene.scene.background});
    indirect[whole] = relighter.latest().indirect;
  }
  double off = 0, all = 0;
  for (size_t i = 0; i < area_m2.size(); ++i) {
    const Rgb d = indirect[0][i] - indirect[1][i];
    off += double(area_m2[i]) * double(dot(d, d));
    all += double(area_m2[i]) * double(dot(indirect[1][i], indirect[1][i]));
  }
  const bool glows = s.lamp == "tiny" || s.lamp == "huge";
  add_entry(accounts,
            glows ? "relight, what the codec loses of glowing squares"
                  : "relight, what the codec loses of point lights and skies",
            {Claim::bound, s.seed, stated, all > 0 ? std::sqrt(off / all) : 0});
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
    if (is_asked_for(params, kRelight)) LUXEL_TRY_STATUS(add_codec(s, accounts, progress));
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
              {Claim::bound, uint64_t(i), f.error, std::abs(f.value - exact)});
    for (const bool hemicube : {false, true}) {
      const viewfactor::SampledParams sampling{.samples = hemicube ? 64u : 1u << 14,
                                               .hemicube = hemicube ? 64 : 0};
      LUXEL_TRY(const viewfactor::SampledFactor sampled,
                viewfactor::sampled_form_factor(c.a, c.b, c.blockers, sampling));
      add_entry(accounts,
                hemicube ? "factors, hemicube, twice the standard error"
                         : "factors, rays, twice the standard error",
                {Claim::bound, uint64_t(i), 2 * sampled.error, std::abs(sampled.value - exact)});
    }
  }
  return {};
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
      "Its noise is taken out.\n"
      "- *where it is reached*: scenes in which no warning says that --max-error was not.\n"
      "- probe states one standard error; twice that is held against {} more paths. `luxel lux` "
      "and `luxel probe --from` state the standard error of their own rays. `luxel render` states "
      "that of its paths, as reference does.\n"
      "- relight states what its codec loses; the truth is the same matrix without a codec. What "
      "its patches cost is in the row of matrix.\n"
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
    const validate::Held h = validate::held(account.claim, account.stated, account.truth);
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
                            {"stated", account.stated},
                            {"true", account.truth}});
  }
  section.markdown = introduction(params.first_seed) +
                     markdown_table({"stated error", "claim", "scenes", "holds",
                                     "true over stated, median", "95th percentile"},
                                    rows);
  return section;
}

}  // namespace luxel::bench
