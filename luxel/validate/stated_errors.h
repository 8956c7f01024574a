// Compares the errors that solvers state with their true errors.
#pragma once

#include <string_view>

#include "luxel/atlas/shared_parts.h"
#include "luxel/validate/agreement.h"

namespace luxel::validate {

/// One solution's stated errors and its true ones, by the judge.
struct StatedError {
  double stated = 0;  ///< TexelLight::relative_error
  /// Root mean square of the luminance's difference from the judge over the mean luminance, without
  /// the judge's noise.
  double truth = 0;
  /// 1.96 of the judge's standard errors below and above `truth`.
  double truth_low = 0, truth_high = 0;
  double stated_p95 = 0;  ///< TexelLight::error_p95; 0: none is stated
  /// 95 % of the texels err by less, relative to themselves or a tenth of the mean. Each texel's
  /// difference from the judge is freed of 1.96 of the judge's standard errors, as squares, which
  /// is exact for normal errors.
  double true_p95 = 0;
  size_t texels = 0;
};
/// Parts of texels that belong to other charts, and the judge's light at their middles.
struct JudgedParts {
  std::vector<atlas::SharedPart> parts;
  Judged judged;
};
/// Errors: cancelled.
Result<JudgedParts> judge_parts(const Prepared& p, int samples_each, uint64_t seed,
                                Progress& progress);
/// Over texels that neither hides, and, for the root mean square, over `shared` parts by their
/// areas. Light without texels or without light states nothing: zeros.
StatedError stated_error(const pipeline::TexelLight& light, const Judged& judged,
                         const JudgedParts& shared = {});

/// Claim that a stated error makes.
enum class Claim {
  bound,     ///< the truth is no larger
  estimate,  ///< the truth is within a factor of kEstimateFactor, either way
};
inline constexpr double kEstimateFactor = 1.5;

/// An error that is stated, and what it is in truth, as far as the judge can tell: between `low`
/// and `high`. A judge without noise knows it exactly.
struct Compared {
  double stated = 0;
  double truth = 0, low = truth, high = truth;
};

/// Solutions in which a claim holds, out of many. A claim that the judge cannot tell from a true
/// one counts as one that holds.
struct Held {
  int scenes = 0;
  int holds = 0;            ///< in so many of them the claim holds
  double middle_ratio = 0;  ///< median of truth / stated
  double p95_ratio = 0;     ///< its 95th percentile
};
/// Entries with nothing stated are left out.
Held held(Claim claim, std::span<const Compared> entries);

}  // namespace luxel::validate
