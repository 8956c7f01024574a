#include "solve/gather/gather.h"

#include <cmath>

namespace luxel::gather {
namespace {

double relative_error(std::span<const Rgb> irradiance, std::span<const float> direct_variance,
                      std::span<const float> gathered_variance) {
  double mean = 0, variance = 0;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    mean += luminance(irradiance[i]);
    variance += double(direct_variance[i]) + double(gathered_variance[i]);
  }
  return mean > 0 ? std::sqrt(variance * double(irradiance.size())) / mean : 0;
}

}  // namespace

Result<Gather> gather(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const atlas::TexelMap& map, const transport::Elements& elements,
                      const transport::Lights& lights, const trace::RayTracer& tracer,
                      const GatherParams& params, Progress& progress) {
  const transport::DirectParams direct_params{params.direct_samples, params.seed};
  LUXEL_TRY(transport::DirectLight direct,
            transport::direct_light(scene, elements, lights, tracer, direct_params, progress));
  LUXEL_TRY(const transport::Supersampled averaged,
            transport::supersample(scene, atlas, map, elements, lights, tracer,
                                   {.points = params.supersample, .direct = direct_params}, direct,
                                   progress));
  const TraceParams trace_params{params.samples, params.seed, params.hit_memory_bytes,
                                 params.scratch_folder, params.bounces < 0 ? &lights : nullptr};
  LUXEL_TRY(TracedHits hits,
            trace_hits(scene, atlas, elements, lights.around, tracer, trace_params, progress));
  LUXEL_TRY(Bounced bounced, bounce(map, elements, hits, direct.irradiance,
                                    places_behind(scene, atlas, map, elements),
                                    {params.bounces, params.tolerance}, progress));
  Gather out;
  out.relative_error = relative_error(bounced.irradiance, direct.variance, bounced.variance);
  out.irradiance = std::move(bounced.irradiance);
  out.direct = std::move(direct.irradiance);
  out.direct_variance = std::move(direct.variance);
  out.indirect_variance = std::move(bounced.split_variance);
  for (size_t i = 0; i < elements.size(); ++i) out.enclosed.push_back(is_enclosed(hits, i));
  out.met_back = std::move(hits.met_back);
  out.rays = direct.rays + averaged.rays + hits.rays;
  out.supersampled = averaged.texels;
  out.sweeps = bounced.sweeps;
  out.hit_bytes_in_file = hits.store.bytes_in_file();
  return out;
}

}  // namespace luxel::gather
