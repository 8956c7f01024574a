// Stated errors against true ones, on random scenes.
#include <fmt/format.h>

#include <map>

#include "bench/validation.h"
#include "luxel/validate/random_scenes.h"
#include "luxel/validate/stated_errors.h"
#include "luxel/viewfactor/random_contacts_test_support.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/visible_form_factor.h"

namespace luxel::bench {
namespace {

/// What one solver or method states and what is true, one entry per scene.
struct Account {
  std::vector<double> stated, truth;
};
using Accounts = std::map<std::string, Account>;

constexpr int kScenes = 100, kResolution = 32, kPathsEach = 256, kSamples = 64, kShadowRays = 16;
constexpr double kMaxError = 0.05;

void add_entry(Account& account, double stated, double truth) {
  account.stated.push_back(stated), account.truth.push_back(truth);
}

Status add_solver(const validate::Prepared& p, const validate::Judged& judged,
                  std::string_view solver, double max_error, Accounts& accounts,
                  Progress& progress) {
  pipeline::BakeSettings settings;
  settings.samples = kSamples, settings.direct_samples = kShadowRays, settings.seed = 7;
  settings.max_error = float(max_error);
  LUXEL_TRY(const validate::Timed solved, validate::solve(p, solver, settings, progress));
  const validate::StatedError e = validate::stated_error(solved.light, judged);
  const std::string name =
      std::string(solver) + (max_error > 0 ? fmt::format(" --max-error {}", max_error) : "");
  add_entry(accounts[name + ", RMS over mean"], e.stated, e.truth);
  if (e.stated_p95 > 0) add_entry(accounts[name + ", 95th percentile"], e.stated_p95, e.true_p95);
  return {};
}

/// Gather and the path tracer on every scene. (hemicube takes more than half a minute on the
/// first.)
Status add_bakes(Accounts& accounts, Progress& progress) {
  for (int seed = 1; seed <= kScenes; ++seed) {
    validate::RandomScene s = validate::random_scene(uint64_t(seed));
    LUXEL_TRY(const auto p, validate::prepare(std::move(s.scene), kResolution, progress));
    LUXEL_TRY(const validate::Judged judged, validate::judge(*p, kPathsEach, 1, progress));
    for (const std::string_view solver : {"gather", "reference"})
      LUXEL_TRY_STATUS(add_solver(*p, judged, solver, 0, accounts, progress));
    LUXEL_TRY_STATUS(add_solver(*p, judged, "gather", kMaxError, accounts, progress));
  }
  return {};
}

/// Every method of `luxel factors` on polygons with blockers close to them.
Status add_factors(Accounts& accounts, Progress& progress) {
  viewfactor::Dice dice{1234, 0};
  for (int i = 0; i < kScenes; ++i) {
    LUXEL_TRY_STATUS(stopped(progress));
    const viewfactor::Contact c = viewfactor::random_contact(dice);
    const double exact = c.exact / viewfactor::area_m2(c.a);
    const viewfactor::FormFactor f = viewfactor::form_factor(c.a, c.b, c.blockers, 1e-4);
    add_entry(accounts["factors, analytic"], f.error, std::abs(f.value - exact));
    for (const bool hemicube : {false, true}) {
      const viewfactor::SampledParams params{.samples = hemicube ? 64u : 1u << 14,
                                             .hemicube = hemicube ? 64 : 0};
      LUXEL_TRY(const viewfactor::SampledFactor sampled,
                viewfactor::sampled_form_factor(c.a, c.b, c.blockers, params));
      add_entry(accounts[hemicube ? "factors, hemicube, twice the standard error"
                                  : "factors, rays, twice the standard error"],
                2 * sampled.error, std::abs(sampled.value - exact));
    }
  }
  return {};
}

}  // namespace

Result<Section> validate_stated_errors(Progress& progress) {
  Accounts accounts;
  LUXEL_TRY_STATUS(add_bakes(accounts, progress));
  LUXEL_TRY_STATUS(add_factors(accounts, progress));
  Section section;
  section.json = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, account] : accounts) {
    const validate::Held h = validate::held(account.stated, account.truth);
    if (h.scenes == 0) continue;
    rows.push_back({name, std::to_string(h.scenes), std::to_string(h.within),
                    fmt::format("{:.2g}", h.middle_ratio), fmt::format("{:.2g}", h.p95_ratio)});
    section.json.push_back({{"error", name},
                            {"scenes", h.scenes},
                            {"within", h.within},
                            {"median_ratio", h.middle_ratio},
                            {"p95_ratio", h.p95_ratio}});
  }
  section.markdown = fmt::format(
      "## Stated errors against true ones\n\n"
      "{} random scenes, decided by seeds: closed rooms of 1 to 10 m and rooms under a sky. They "
      "hold plates and walls of a ten-thousandth to a hundredth of the room, slivers, and boxes. "
      "Lamps are tiny or huge. *scenes*: those in which an error is stated. *within*: the true "
      "error is no larger than the stated one. *true over stated*: median and 95th percentile over "
      "the scenes. A standard error that is right has a median near 1, and an upper bound holds in "
      "all scenes.\n\n"
      "Bakes: {} x {} texels, {} rays, {} shadow rays. The truth is the path tracer, twice {} "
      "paths per texel; its noise is taken out of the RMS, and is left in the percentile. gather "
      "states the percentile of standard errors. That of errors, which it is held against here, is "
      "1.96 times as large where all texels are equally noisy. Stated errors are of the noise; the "
      "true ones include what a method cannot show. Not in the table yet: hemicube, matrix, "
      "hierarchical, relight and probe. Factors: blockers that touch a polygon or nearly do; the "
      "truth is in closed form.\n\n{}",
      kScenes, kResolution, kResolution, kSamples, kShadowRays, kPathsEach,
      markdown_table(
          {"stated error", "scenes", "within", "true over stated, median", "95th percentile"},
          rows));
  return section;
}

}  // namespace luxel::bench
