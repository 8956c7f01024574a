// How far the light of points is off that a solver reads from a mesh of its own.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/surroundings.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::light {

/// What is checked, and against what.
struct PointCheck {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const Surroundings& around;
  /// What the solver says that the surface that a ray meets sends, its emission aside [W/m^2].
  std::function<Rgb(const trace::Hit&)> radiosity;
  uint64_t seed = 1;
};

/// Some hundred of so many points, spread over all but those with `hidden`.
std::vector<uint32_t> points_to_check(size_t count, std::span<const uint8_t> hidden);

/// Root mean square error of E at points_to_check() [W/m^2, luminance], at most two standard
/// errors more than was found. `gathered` is E per point of light that was reflected, or comes from
/// the surroundings' soft layer. At each point rays look at what surfaces send, once and again:
/// with two such answers a and b, (g - a)(g - b) has the mean of the square of g's error, and the
/// noise of the rays drops out. So this is what the size of the solver's elements costs near
/// contacts and borders of light. Errors: cancelled.
Result<double> point_error(const PointCheck& check, const transport::Elements& points,
                           std::span<const Rgb> gathered, std::span<const uint8_t> hidden,
                           Progress& progress);

}  // namespace luxel::light
