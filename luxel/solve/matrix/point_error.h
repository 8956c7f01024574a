// How far the light of points is off that is read from the patches around them.
#pragma once

#include <span>

#include "luxel/light/surroundings.h"
#include "luxel/solve/matrix/matrix.h"
#include "luxel/transport/elements.h"

namespace luxel::matrix {

/// What is checked, and against what.
struct PointCheck {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const light::Surroundings& around;
  const Prepared& prepared;
  const Solution& solution;
};

/// Root mean square error of indirect light at some of the points [W/m^2, luminance], at most one
/// standard error more than was found. At each of some hundred points rays look at the patches,
/// once and again: with two such answers a and b, (g - a)(g - b) has the mean of the square of g's
/// error, and the noise of the rays drops out. So this is what the size of patches costs near
/// contacts and borders of light. `indirect`: g, per point; points with `hidden` are left out.
/// Errors: cancelled.
Result<double> point_error(const PointCheck& check, const transport::Elements& points,
                           std::span<const Rgb> indirect, std::span<const uint8_t> hidden,
                           uint64_t seed, Progress& progress);

}  // namespace luxel::matrix
