// Light to try codecs with, and what the factors themselves make of it.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/solve/matrix/matrix.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

struct TrialParams {
  int count = 8;
  int bounces = -1;  ///< products; < 0: all
  uint64_t seed = 1;
};

struct Trials {
  std::vector<std::vector<Rgb>> sent, irradiance;  ///< per trial, per patch
};

/// Punctual lights in the open, each between a patch and what a ray from there meets: what patches
/// reflect of each at first, and the irradiance that all of them get from each other of that,
/// converged. Errors: cancelled.
Result<Trials> make_trials(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const Prepared& prepared, const CoarseScene& coarse,
                           const TrialParams& params, Progress& progress);

/// The fewest sweeps of all_bounces with the factors themselves that err by `error` or less,
/// relative as in error_of.
int enough_sweeps(const Prepared& prepared, const CoarseScene& coarse, const Trials& trials,
                  double error);

/// What the plain iteration with the factors themselves errs by after 1, 2, ..., `products` of
/// them.
std::vector<double> errors_of_products(const Prepared& prepared, const Trials& trials,
                                       int products);

/// Relative root mean square of the irradiance, over all trials and patches, by area; every trial
/// counts alike.
double error_of(const Codec& codec, const Trials& trials, const Patches& patches, int bounces);

}  // namespace luxel::matrix
