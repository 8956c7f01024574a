// Cutting triangles where the light varies, shadow borders first.
#pragma once

#include "luxel/solve/hemicube/exchange.h"
#include "luxel/solve/hemicube/hemicube.h"

namespace luxel::hemicube {

/// The likely error of linear (vertex) or constant (triangle) interpolation on each triangle of the
/// mesh, as luminance [W/m^2]: the kink of the light across its edges, which a linear function has
/// not. Along an edge between triangles of heights h_1, h_2 with slopes g_1, g_2 away from it, a
/// function of constant curvature k has g_1 + g_2 = k (h_1 + h_2) / 2 and errs by k h^2 / 8, and
/// one that jumps by J errs by J / 2, so (g_1 + g_2) h / 4 stands between both. Triangles with
/// `unseen` = 1 do not err, and are no neighbours to others: their light is made up. Empty: none.
std::vector<float> interpolation_errors(const Field& field, std::span<const uint8_t> unseen = {});

/// Root mean square of these over the area, over the mean irradiance.
double relative_interpolation_error(const Field& field);

/// The scene and the mesh in it that elements look at.
struct SendingScene {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const Emission& emission;
  const Mesh& mesh;                    ///< what is looked at
  const Receivers& senders;            ///< its elements
  const Observer* observer = nullptr;  ///< hears of each look; null: nobody does
};

/// Views of elements, and the light that reaches them without any reflection.
struct Sight {
  Rows rows;
  std::vector<Rgb> source;  ///< per row: E_0
};

/// Looks from elements of a mesh, their own or a finer one, and gathers their direct light. Counts
/// rays and seconds in `solution`. Errors: cancelled, disk full.
Result<Sight> look_from(const SendingScene& around, const transport::Elements& elements,
                        const HemicubeParams& params, Solution& solution, Progress& progress);

/// Cuts triangles of a solution until interpolation errs by no more than params.max_error or there
/// are max_elements. In: a field over the mesh around, solved. New elements gather the light that
/// its elements send. Errors: cancelled, disk full.
Status refine(const SendingScene& around, const HemicubeParams& params, size_t max_elements,
              Solution& solution, Progress& progress);

}  // namespace luxel::hemicube
