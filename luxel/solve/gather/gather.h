// Radiosity maps: Monte Carlo gather per texel. [Moreno05]
#pragma once

#include <functional>

#include "luxel/light/light_estimate.h"
#include "luxel/light/supersample.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/gather_params.h"
#include "luxel/solve/gather/reuse/earlier.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {

/// What gather found, one value per element.
struct Gather {
  std::vector<Rgb> irradiance;  ///< E per element [W/m^2], after all bounces
  std::vector<Rgb> direct;      ///< the part of it that comes straight from lamps
  /// Estimated variance of the mean's luminance, per element: of the direct part and of the rest.
  std::vector<float> direct_variance, indirect_variance;  ///< indirect: from halves, see Bounced
  std::vector<uint16_t> met_back;  ///< rays per element that met the back of a one-sided surface
  std::vector<uint8_t> enclosed;   ///< per element: 1 inside a solid (transport::is_enclosed)
  std::vector<float> pooled_variance;  ///< of the luminance, per element: pooled_variances
  std::vector<float> errors;           ///< per element: relative_errors
  std::vector<float> gathered_errors;  ///< the same of what rays brought, light from lamps aside
  float relative_error_p95 = 0;        ///< 95th percentile of `errors`
  std::vector<uint16_t> samples;       ///< indirect rays per element
  /// With layers, of each: E per element after all bounces. They add up to `irradiance`.
  std::vector<std::vector<Rgb>> layers;
  double layers_shared_out = 0;  ///< LayersBounced::shared_out
  /// With `keep`: direct light as it is in the end, and how finely it was looked at.
  light::DirectLight kept_direct;
  light::DirectLevels kept_levels;
  uint64_t rays = 0;
  uint64_t rays_kept = 0;     ///< TracedHits::rays_kept
  uint64_t supersampled = 0;  ///< elements whose direct light is a mean over points
  int sweeps = 0;
  uint64_t hit_bytes_in_file = 0;
  /// Root mean square of the estimated standard errors (pooled_variances) over the mean irradiance.
  double relative_error = 0;
};

/// Direct light, rays, bounces: the chain of docs/method/gather.md. Errors: cancelled, disk full.
Result<Gather> gather(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const atlas::TexelMap& map, const transport::Elements& elements,
                      const light::Lights& lights, const trace::RayTracer& tracer,
                      const GatherParams& params, Progress& progress);

}  // namespace luxel::gather
