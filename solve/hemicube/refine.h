// Cutting triangles where the light varies, shadow borders first.
#pragma once

#include "solve/hemicube/exchange.h"
#include "solve/hemicube/hemicube.h"

namespace luxel::hemicube {

/// How far linear (vertex) or constant (triangle) interpolation may err on each triangle of the
/// mesh, as luminance [W/m^2]: the kink of the light across its edges, which a linear function has
/// not. Along an edge between triangles of heights h_1, h_2 with slopes g_1, g_2 away from it, a
/// function of constant curvature k has g_1 + g_2 = k (h_1 + h_2) / 2 and errs by k h^2 / 8, and
/// one that jumps by J errs by J / 2, so (g_1 + g_2) h / 4 stands between both.
std::vector<float> interpolation_errors(const Field& field);

/// Root mean square of these over the area, over the mean irradiance.
double relative_interpolation_error(const Field& field);

struct Refinement {
  Solution& solution;  ///< in: solved; out: with more elements
  const Emission& emission;
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
};

/// Cuts triangles of the solution's field until interpolation errs by no more than params.max_error
/// or there are max_elements. New elements look at the elements that the solution had before and
/// gather their radiosity; they send none themselves. Errors: cancelled.
Status refine(const Refinement& in, const HemicubeParams& params, size_t max_elements,
              Progress& progress);

}  // namespace luxel::hemicube
