// Light to try codecs with, and what the factors themselves make of it.
#pragma once

#include <optional>

#include "luxel/base/progress.h"
#include "luxel/solve/matrix/matrix.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

struct TrialParams {
  /// Point lights: with room around them, and others no closer to a surface than a patch is wide.
  int in_the_open = 8, anywhere = 8;
  int bounces = -1;  ///< products; < 0: all
  uint64_t seed = 1;
  /// With it, the scene's own lights are tried, too, its background, and materials, one at a time.
  const Glow* glow = nullptr;
};

/// Lights that were tried: what patches send, and what they get.
struct Trials {
  std::vector<std::vector<Rgb>> sent;        ///< per trial, per patch: what is reflected at first
  std::vector<std::vector<Rgb>> straight;    ///< E from glowing surfaces and the background
  std::vector<std::vector<Rgb>> irradiance;  ///< E from `sent`

  /// Number [k][t] is the error of all_bounces() with the factors themselves in trial t after k + 1
  /// sweeps, up to the most that were tried. Empty where bounces are counted.
  std::vector<std::vector<double>> error_of_sweeps;

  /// The first of them are point lights in the open, then come some anywhere.
  size_t in_the_open = 0, anywhere = 0;

  size_t size() const { return sent.size(); }
};

/// The side of a square as large as a mean patch [m].
float side_of_patches(std::span<const float> area_m2);

/// Where lamps may stand.
struct LampScene {
  const trace::RayTracer& tracer;
  std::span<const Vec3> position, normal;  ///< of patches
  float farthest_m = 1;                    ///< the scene's size
  float clearance_m = 0;                   ///< to all surfaces, where such places are found
};
/// A point light somewhere between two surfaces; none where no place inside of a room is found.
std::optional<scene::PunctualLight> lamp_at_random(const LampScene& scene, uint64_t seed);

/// Point lights at random, and others as params.glow says: what patches reflect of each at first,
/// and the irradiance that all of them get from each other of that, converged. Errors: cancelled.
Result<Trials> make_trials(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const Prepared& prepared, const CoarseScene& coarse,
                           const TrialParams& params, Progress& progress);

/// The fewest sweeps of all_bounces, at least 2, with the factors themselves that err by `error` or
/// less, by usual_error().
int enough_sweeps(const Trials& trials, double error);

/// Errors of the plain iteration with the factors themselves after 1, 2, ..., `products` of them,
/// root mean square over all trials.
std::vector<double> errors_of_products(const Prepared& prepared, const Trials& trials,
                                       int products);

/// Relative root mean square error of the irradiance over all patches, by area, of each trial.
std::vector<double> errors_of(const Codec& codec, const Trials& trials, const Patches& patches,
                              int bounces);

/// errors_of(), but trials that erred by more `before` come first, and as soon as those that were
/// tried are sure to make usual_error() exceed `most`, the others are not tried: they are taken to
/// have changed as these did.
std::vector<double> errors_until(const Codec& codec, const Trials& trials, const Patches& patches,
                                 int bounces, std::span<const double> before, double most);

/// The error that codecs are held to, from errors_of(): root mean square over the point lights in
/// the open, or the largest of the other lights if that is more. Point lights anywhere do not
/// count.
double usual_error(const Trials& trials, std::span<const double> errors);

/// An error that lights which were not tried seldom exceed: the most of errors_of(), or, if that is
/// more, the mean and some standard deviations over the point lights anywhere.
double largest_error(const Trials& trials, std::span<const double> errors);

}  // namespace luxel::matrix
