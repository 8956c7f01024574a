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

/// What a refinement works on.
struct Refinement {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const Emission& emission;
  const Mesh& sending_mesh;  ///< the mesh that `blocks` were made on; it stays what is looked at
  const Receivers& sending;
  Solution& solution;          ///< in: solved; out: with more elements
  std::vector<Block>& blocks;  ///< gets one more per round
};

/// Cuts triangles of the solution's field until interpolation errs by no more than params.max_error
/// or there are max_elements, then lets all elements exchange light once more. New elements look at
/// the senders, and from then on the senders send on their behalf. Errors: cancelled, disk full.
Status refine(const Refinement& in, const HemicubeParams& params, size_t max_elements,
              Progress& progress);

/// Looks from some of the elements and gathers their direct light.
Result<Block> make_block(const Refinement& in, const Receivers& receivers,
                         std::span<const uint32_t> elements, const HemicubeParams& params,
                         Progress& progress);

}  // namespace luxel::hemicube
