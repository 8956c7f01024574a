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
#include "luxel/pipeline/solver/sharing_error.h"
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
  account.hard.push_back(entry.hard);
}

namespace {

using validate::Claim;

constexpr int kScenes = 100, kResolution = 32, kShadowRays = 16;
constexpr int kStatedSamples = 64, kReferencePaths = 256;
/// Paths of the judge where they are reflected a hundred times: an hour would go into them.
constexpr int kPathsEachInWhite = kPathsEach / 4;
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

/// Meaning of a solver's RMS: an error measured by rays is stated with one standard error more.
Claim claim_of(std::string_view solver) {
  const bool is_measured = solver == "matrix" || solver == "hemicube" || solver == "hierarchical";
  return is_measured ? Claim::bound : Claim::estimate;
}

/// The error that a bake of this light states, and the true one.
Result<validate::StatedError> stated_by_bake(const JudgedScene& s,
                                             const pipeline::TexelLight& light, double stated,
                                             Progress& progress) {
  validate::StatedError out = validate::stated_error(light, s.judged, s.shared);
  if (out.texels == 0) return out;  // without light nothing is stated
  LUXEL_TRY(const double sharing, pipeline::sharing_error(s.scene.input(), light, {}, progress));
  out.stated = std::hypot(stated, sharing);
  return out;
}

Status add_solver(const JudgedScene& s, std::string_view solver, double max_error,
                  Accounts& accounts, Progress& progress) {
  pipeline::BakeSettings settings = small_settings(s, solver);
  settings.max_error = float(max_error);
  settings.denoise = solver == "gather" && max_error <= 0, settings.supersample = 1;
  LUXEL_TRY(validate::Timed solved, validate::solve(s.scene, solver, settings, progress));
  LUXEL_TRY(const validate::StatedError e,
            stated_by_bake(s, solved.light, solved.light.relative_error, progress));
  const std::string name =
      std::string(solver) + (max_error > 0 ? fmt::format(" --max-error {}", max_error) : "");
  const auto add = [&](std::string_view what, Claim claim, const validate::Compared& compared) {
    add_entry(accounts, name + std::string(what), {claim, s.seed, compared, s.hard});
  };
  add(", RMS over mean", claim_of(solver), {e.stated, e.truth, e.truth_low, e.truth_high});
  if (e.stated_p95 > 0)
    add(", 95 % of texels err by less", Claim::bound, {e.stated_p95, e.true_p95});
  // The error asked for is a statement, too, where no warning says that it was not reached.
  if (max_error > 0 && e.stated_p95 <= max_error)
    add(", where it is reached", Claim::bound, {max_error, e.true_p95});
  if (!settings.denoise) return {};
  LUXEL_TRY_STATUS(pipeline::denoise_light(s.scene.input(), settings, {}, solved.light, progress));
  LUXEL_TRY(const validate::StatedError left,
            stated_by_bake(s, solved.light, solved.light.delivered_error.value_or(0), progress));
  add(" --denoise, RMS over mean", Claim::estimate,
      {left.stated, left.truth, left.truth_low, left.truth_high});
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
  add_entry(accounts, "probe, twice the standard error",
            {Claim::bound,
             s.seed,
             {2 * double(probed.luminance_error), std::sqrt(std::max(0.0, off * off - 4 * noise2))},
             s.hard});
  return {};
}

/// True where these rows are asked for: all are, or those of this solver or command.
bool is_asked_for(const StatedParams& params, std::string_view what) {
  return params.only.empty() || params.only == what;
}

/// Every solver and the probe on a scene, and the relighter on rooms.
Status add_scene(uint64_t seed, validate::Hard hard, const StatedParams& params, Accounts& accounts,
                 Progress& progress) {
  validate::RandomScene random = validate::random_scene(seed, hard);
  LUXEL_TRY(const auto p, validate::prepare(std::move(random.scene), kResolution, progress));
  const int paths = hard == validate::Hard::white ? kPathsEachInWhite : kPathsEach;
  LUXEL_TRY(const validate::Judged judged, validate::judge(*p, paths, 1, progress));
  LUXEL_TRY(validate::JudgedParts shared, validate::judge_parts(*p, paths, 1, progress));
  const JudgedScene s{*p, judged, seed, random.lamp, hard, std::move(shared)};
  for (const std::string_view solver : kStatedSolvers)
    if (is_asked_for(params, solver))
      LUXEL_TRY_STATUS(add_solver(s, solver, 0, accounts, progress));
  if (is_asked_for(params, "gather"))
    LUXEL_TRY_STATUS(add_solver(s, "gather", kMaxError, accounts, progress));
  if (is_asked_for(params, kProbe)) LUXEL_TRY_STATUS(add_probe(s, accounts, progress));
  if (is_asked_for(params, kRelight) && hard == validate::Hard::nothing)
    LUXEL_TRY_STATUS(add_relight(s, accounts, progress));
  return {};
}

/// Rooms, and as many hard scenes, of each kind in turn.
Status add_scenes(const StatedParams& params, Accounts& accounts, Progress& progress) {
  if (params.only == kFactors) return {};
  for (int k = 0; k < kScenes; ++k) {
    const uint64_t seed = params.first_seed + uint64_t(k);
    LUXEL_TRY_STATUS(add_scene(seed, validate::Hard::nothing, params, accounts, progress));
    if (params.only == kRelight) continue;
    const validate::Hard hard = validate::kHard[size_t(k) % validate::kHard.size()];
    LUXEL_TRY_STATUS(add_scene(seed, hard, params, accounts, progress));
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

/// The part of an account that is about scenes which this is hard about.
std::vector<validate::Compared> only(const Account& account, validate::Hard hard) {
  std::vector<validate::Compared> out;
  for (size_t k = 0; k < account.compared.size(); ++k)
    if (account.hard[k] == hard) out.push_back(account.compared[k]);
  return out;
}

const char* text_of(Claim claim) { return claim == Claim::bound ? "bound" : "estimate"; }

/// A table of how often errors hold in rooms.
std::string table_of_rooms(const Accounts& accounts) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, account] : accounts) {
    const validate::Held h = validate::held(account.claim, only(account, validate::Hard::nothing));
    if (h.scenes == 0) continue;
    rows.push_back({name, text_of(account.claim), std::to_string(h.scenes), std::to_string(h.holds),
                    fmt::format("{:.2g}", h.middle_ratio), fmt::format("{:.2g}", h.p95_ratio)});
  }
  return markdown_table(
      {"stated error", "claim", "scenes", "holds", "true over stated, median", "95th percentile"},
      rows);
}

/// A table of how often they hold in hard scenes, of each kind and of all.
std::string table_of_hard_scenes(const Accounts& accounts) {
  std::vector<std::string> columns{"stated error", "scenes", "holds"};
  for (const validate::Hard hard : validate::kHard) columns.emplace_back(validate::name_of(hard));
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, account] : accounts) {
    int scenes = 0, holds = 0;
    std::vector<std::string> by_kind;
    for (const validate::Hard hard : validate::kHard) {
      const validate::Held h = validate::held(account.claim, only(account, hard));
      by_kind.push_back(h.scenes == 0 ? "" : fmt::format("{} of {}", h.holds, h.scenes));
      scenes += h.scenes, holds += h.holds;
    }
    if (scenes == 0) continue;
    rows.push_back({name, std::to_string(scenes), std::to_string(holds)});
    rows.back().insert(rows.back().end(), by_kind.begin(), by_kind.end());
  }
  return rows.empty() ? "" : markdown_table(columns, rows);
}

/// The page's words on what is hard about scenes.
constexpr const char* kAboutHardScenes =
    "\nHard scenes are as many, of seven kinds in turn:\n\n"
    "- *slats*: direct light falls through a row of slats, or through rings.\n"
    "- *masks*: two sheets with holes hang in the room.\n"
    "- *overlaps*: TEXCOORD_1 has charts that share the texels at their borders. The truth counts "
    "every part of a texel.\n"
    "- *far*: the room lies up to eight times its size from the origin. Scenes farther away are "
    "moved when they are read.\n"
    "- *road*: a strip of ground, 30 to 400 times as long as the room, passes it.\n"
    "- *white*: all surfaces reflect 0.99. Here the judge has a quarter of the paths.\n"
    "- *barriers*: two walls thinner than texels part the room, from wall to wall.\n\n";

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
  for (const auto& [name, account] : accounts) {
    std::vector<std::string> hard;
    for (const validate::Hard h : account.hard) hard.emplace_back(validate::name_of(h));
    section.json.push_back({{"error", name},
                            {"claim", text_of(account.claim)},
                            {"seeds", account.seed},
                            {"hard", hard},
                            {"stated", values(account, &validate::Compared::stated)},
                            {"true", values(account, &validate::Compared::truth)},
                            {"true_low", values(account, &validate::Compared::low)},
                            {"true_high", values(account, &validate::Compared::high)}});
  }
  section.markdown = introduction(params.first_seed) + table_of_rooms(accounts);
  if (const std::string hard = table_of_hard_scenes(accounts); !hard.empty())
    section.markdown += kAboutHardScenes + hard;
  return section;
}

}  // namespace luxel::bench
