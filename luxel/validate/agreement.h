// Solvers against the path tracer, on small scenes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "luxel/reference/path_tracer.h"
#include "luxel/validate/prepared.h"

namespace luxel::validate {

/// A scene on which solvers must agree with the path tracer.
struct AgreementScene {
  std::string name;
  scene::Scene scene;
  int resolution = 64;
  std::string shows;  ///< what kind of light it is there for
};
/// Area light, point light in a closed room, curved surfaces under a sky, every kind of light with
/// textures and masks, sun through a window, the same from a map, sun through coloured panes, sky
/// and indirect light through coloured glass.
std::vector<AgreementScene> agreement_scenes();

/// The judge's answer, twice, from independent paths.
struct Judged {
  std::vector<Rgb> first, second;   ///< E per element
  std::vector<uint8_t> hidden;      ///< inside a solid: not compared
  std::vector<Rgb> standard_error;  ///< of the mean of both
  double seconds = 0;
  uint64_t rays = 0;

  Rgb mean(size_t i) const { return 0.5f * (first[i] + second[i]); }
};
/// The judge's answer at all elements. Errors: cancelled.
Result<Judged> judge(const Prepared& p, int samples_each, uint64_t seed, Progress& progress);
/// The judge's answer at any points of surfaces. Errors: cancelled.
Result<Judged> judge(const scene::Scene& scene, const trace::RayTracer& tracer,
                     const reference::Receivers& receivers, int samples_each, uint64_t seed,
                     Progress& progress);

/// Distance of a solver's E from the truth. With D = g - truth and two independent, unbiased
/// answers a and b of the judge, the mean of (g - a)(g - b) tends to the mean of D^2: the judge's
/// own noise drops out. Relative errors are D / (g + 0.01 mean(g)): relative to the solver, because
/// a noisy denominator that goes with a and b would bring their noise back; `luxel compare` divides
/// by the reference, which differs in the second order of D.
struct Agreement {
  uint64_t texels = 0;
  double relative_rmse = 0;  ///< of the solver alone; 0 where the noise leaves nothing
  /// A relative RMSE below this cannot be told from none: two standard errors of its square.
  double resolution = 0;
  double bias_over_mean = 0;  ///< signed
  double judge_noise = 0;  ///< what the judge's noise would add to relative_rmse, were it left in
};
/// Compares a solver with the judge at elements that neither takes for the inside of a solid.
Agreement agreement(std::span<const Rgb> solved, std::span<const uint8_t> solver_hidden,
                    const Judged& judged);

/// Errors of luminance against a reference b, d being the difference.
struct Errors {
  double relative = 0;   ///< root mean square of d / (b + 0.01 mean b), as `luxel compare` has it
  double over_mean = 0;  ///< root mean square of d over the mean
  double mean = 0;       ///< of d over the mean
};
/// Over texels that are not hidden; `hidden` may be empty.
Errors errors_of(std::span<const Rgb> light, std::span<const Rgb> reference,
                 std::span<const uint8_t> hidden);

/// "0.44 %", or "< 0.2 %" where nothing can be told.
std::string relative_rmse_text(const Agreement& a);

}  // namespace luxel::validate
