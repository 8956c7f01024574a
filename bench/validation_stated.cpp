// Stated errors against true ones, on random scenes.
#include <fmt/format.h>

#include <array>

#include "bench/stated_accounts.h"
#include "bench/validation.h"
#include "luxel/base/random.h"
#include "luxel/pipeline/bake/denoise_light.h"
#include "luxel/pipeline/command/probe.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/origin.h"
#include "luxel/validate/random_scenes.h"
#include "luxel/validate/stated_errors.h"
#include "luxel/viewfactor/random_contacts.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/visible_form_factor.h"

namespace luxel::bench {

void add_entry(Accounts& accounts, const std::string& name, const Entry& entry) {
  Account& account = accounts[name];
  account.claim = entry.claim;
  account.compared.push_back(entry.compared), account.seed.push_back(entry.seed);
}

namespace {

using validate::Claim;

constexpr int kScenes = 100, kResolution = 32, kShadowRays = 16;
constexpr int kStatedSamples = 64, kReferencePaths = 256;
constexpr double kMaxError = 0.05;
/// Two million paths in the last: enough for a point of a millionth of the mean light.
constexpr int kProbeRounds = 10;
constexpr std::array<std::string_view, 5> kStatedSolvers{"gather", "reference", "hemicube",
                                                         "matrix", "hierarchical"};
constexpr const char *kProbe = "probe", *kRelight = "relight", *kFactors = "factors";

/// Settings of every solver that let a scene take about a second of one core.
pipeline::BakeSettings small_settings(const JudgedScene& s, std::string_view solver) {
  pipeline::BakeSettings out;
  out.samples = solver == "reference" ? kReferencePaths : kStatedSamples;
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
  settings.denoise = solver == "gather" && max_error <= 0, settings.supersample = 1;
  LUXEL_TRY(validate::Timed solved, validate::solve(s.scene, solver, settings, progress));
  const validate::StatedError e = validate::stated_error(solved.light, s.judged);
  const std::string name =
      std::string(solver) + (max_error > 0 ? fmt::format(" --max-error {}", max_error) : "");
  add_entry(accounts, name + ", RMS over mean",
            {claim_of(solver), s.seed, {e.stated, e.truth, e.truth_low, e.truth_high}});
  if (e.stated_p95 > 0)
    add_entry(accounts, name + ", 95 % of texels err by less",
              {Claim::bound, s.seed, {e.stated_p95, e.true_p95}});
  if (settings.denoise) {
    LUXEL_TRY_STATUS(
        pipeline::denoise_light(s.scene.input(), settings, {}, solved.light, progress));
    const validate::StatedError left = validate::stated_error(solved.light, s.judged);
    add_entry(
        accounts, "gather --denoise, RMS over mean",
        {Claim::estimate,
         s.seed,
         {solved.light.delivered_error.value_or(0), left.truth, left.truth_low, left.truth_high}});
  }
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
  settings.at = scene::in_world(s.scene.scene, elements.position[i]);
  settings.normal = elements.normal[i], settings.in_air = true;
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

/// Whether these rows are asked for: all, or those of one solver or command.
bool is_asked_for(const StatedParams& params, std::string_view what) {
  return params.only.empty() || params.only == what;
}

/// Every solver, the relighter and the probe on every scene.
Status add_scenes(const StatedParams& params, Accounts& accounts, Progress& progress) {
  if (params.only == kFactors) return {};
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
      "They hold boxes, plates close above the floor, thin walls and slivers; the gaps and widths "
      "are a ten-thousandth to a hundredth of the room. Lamps are tiny or huge. For factors, the "
      "blockers touch a polygon or nearly do, and the truth is in closed form.\n\n"
      "- A *bound* holds where the truth is no larger. An *estimate* holds where the truth is "
      "within a factor of {} of it, either way.\n"
      "- *scenes* counts the scenes in which an error is stated; *holds* counts those in which the "
      "claim holds. *true over stated* is a median and a 95th percentile over the scenes.\n"
      "- Errors of texels are relative to their own light, or to a tenth of the mean where they "
      "are darker. RMS is relative to the mean light.\n"
      "- Bakes have {} x {} texels. gather: {} rays and {} shadow rays; reference: {} paths; "
      "hemicube: {} elements of {} pixels; matrix: 1,024 patches of 512 rays; hierarchical: an eps "
      "of 3 % of the mean light, and at most 300 of the smallest elements.\n"
      "- The truth of bakes comes from the path tracer at the texels' sample points, by two runs "
      "of {} paths each. Its noise is taken out: an RMS counts as false if 1.96 standard errors of "
      "the paths do not explain it.\n"
      "- *where it is reached*: only scenes without a warning that --max-error was not reached.\n"
      "- probe states one standard error, at most. Twice that error is compared with the result of "
      "{} more paths. `luxel lux` and `luxel probe --from` state the standard error of their own "
      "rays. `luxel render` states that of its paths, as reference does.\n"
      "- relight has 512 patches of 2,048 rays. It states the loss of its codec in indirect light; "
      "the truth there is the same matrix without a codec. It also states the RMS of all indirect "
      "light over its mean, for the scene's lights and for point lights; the truth there is the "
      "path tracer. A light that comes later stands no closer to a surface than a patch is wide.\n"
      "- `luxel compare` states no error.\n\n",
      kScenes, first_seed, validate::kEstimateFactor, kResolution, kResolution, kStatedSamples,
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
