#include "solve/gather/gather.h"

#include <cmath>

#include "base/parallel.h"
#include "transport/backs_seen.h"

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

/// Per element, whether it lies inside a solid (is_enclosed). Where its own rays are not sure, a
/// fixed set decides, so that other samples or another seed do not turn a texel on and off.
std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const transport::Elements& elements,
                                   const trace::RayTracer& tracer, const TracedHits& hits) {
  constexpr int kRays = 64;
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int one_sided = int(hits.met_back[i]), n = int(hits.samples[i]);
      const int backs = one_sided + int(hits.met_double_sided_back[i]);
      if (4 * one_sided < n && 8 * backs < 7 * n) continue;
      const Vec3 from =
          trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
      out[i] = 4 * one_sided > 3 * n || transport::is_enclosed(transport::backs_seen(
                                            scene, tracer, from, elements.normal[i], kRays));
    }
  });
  return out;
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
  const TraceParams trace_params{params.seed, params.hit_memory_bytes, params.scratch_folder,
                                 params.bounces < 0 ? &lights : nullptr};
  LUXEL_TRY(TracedHits hits, trace_hits(scene, atlas, elements, lights.around, tracer,
                                        params.samples, trace_params, progress));
  LUXEL_TRY(Bounced bounced, bounce(map, elements, hits, direct.irradiance,
                                    places_behind(scene, atlas, map, elements),
                                    {params.bounces, params.tolerance}, progress));
  Gather out;
  out.relative_error = relative_error(bounced.irradiance, direct.variance, bounced.variance);
  out.irradiance = std::move(bounced.irradiance);
  out.direct = std::move(direct.irradiance);
  out.direct_variance = std::move(direct.variance);
  out.indirect_variance = std::move(bounced.split_variance);
  out.enclosed = find_enclosed(scene, elements, tracer, hits);
  out.met_back = std::move(hits.met_back);
  out.rays = direct.rays + averaged.rays + hits.rays;
  out.supersampled = averaged.texels;
  out.sweeps = bounced.sweeps;
  out.hit_bytes_in_file = hits.bytes_in_file();
  return out;
}

}  // namespace luxel::gather
