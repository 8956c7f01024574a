// Radiosity between patches by their form-factor matrix, carried back to the places that ask.
// [Shcherbakov17, sections 3.2 to 3.4]
#pragma once

#include "luxel/light/lights.h"
#include "luxel/solve/matrix/form_factors.h"
#include "luxel/solve/matrix/patches.h"
#include "luxel/solve/matrix/transfer.h"

namespace luxel::matrix {

/// Settings of the matrix solver.
struct MatrixParams {
  PatchParams patches;
  FactorParams factors;
  int direct_samples = 64;  ///< shadow rays per patch towards each light, spread over its points
  int bounces = -1;         ///< products; < 0: until the light to come is below `tolerance`
  float tolerance = 1e-4f;  ///< root mean square over the patches, relative to the mean
  uint64_t seed = 1;
};

/// A scene prepared: everything that does not depend on its lights.
struct Prepared {
  PatchedScene patched;
  FormFactors factors;     ///< reciprocal
  std::vector<float> sky;  ///< per patch: the share of its hemisphere that is background
  uint64_t rays = 0;
};

/// Memory that preparation holds at most, about [bytes].
uint64_t bytes_of_preparation(size_t patches, int rays_per_patch);

/// Patches and the exchange between them, whose rays the members of a team share out. Errors: no
/// surface, cancelled, another member of the team gives up.
Result<Prepared> prepare(const scene::Scene& scene, const trace::RayTracer& tracer,
                         const MatrixParams& params, Progress& progress, Team* team = nullptr);

/// The light of each patch [W/m^2].
struct Solution {
  std::vector<Rgb> direct;    ///< per patch: E straight from lights, without the background
  std::vector<Rgb> indirect;  ///< per patch: E from the background and from all other patches
  uint64_t rays = 0;
  int sweeps = 0;
  double relative_error = 0;  ///< of the rays, an upper bound: root mean square over the mean light
};

/// E = pi L sky + F (rho (D + E)), by repeated products [Shcherbakov17, eq. 3, 4]. Errors:
/// cancelled.
Result<Solution> solve(const scene::Scene& scene, const light::Lights& lights,
                       const trace::RayTracer& tracer, const Prepared& prepared,
                       const MatrixParams& params, Progress& progress);

}  // namespace luxel::matrix
