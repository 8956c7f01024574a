#include "solve/gather/gather.h"

#include <cmath>

#include "base/parallel.h"
#include "solve/gather/adaptive.h"
#include "solve/gather/bounce_layers.h"
#include "transport/backs_seen.h"

namespace luxel::gather {
namespace {

double relative_error(std::span<const Rgb> irradiance, std::span<const float> variance) {
  double mean = 0, sum = 0;
  for (size_t i = 0; i < irradiance.size(); ++i)
    mean += double(luminance(irradiance[i])), sum += double(variance[i]);
  return mean > 0 ? std::sqrt(sum * double(irradiance.size())) / mean : 0;
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

/// While samples are still to come the bounces need not be exact.
constexpr float kRoughTolerance = 1e-2f;

/// Pooled variances, and relative errors by them.
struct Errors {
  std::vector<float> variance;
  std::vector<float> direct, gathered, all;  ///< relative
};

Errors errors_of(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                 const transport::DirectLight& direct, const Bounced& bounced,
                 const TracedHits& hits) {
  const auto of_direct = pooled_variances(atlas, map, {direct.variance, direct.split_variance});
  const auto gathered = pooled_variances(atlas, map, {bounced.variance, bounced.split_variance});
  Errors out;
  for (size_t i = 0; i < gathered.size(); ++i) out.variance.push_back(of_direct[i] + gathered[i]);
  out.direct = relative_errors(of_direct, bounced.irradiance, hits);
  out.gathered = relative_errors(gathered, bounced.irradiance, hits);
  out.all = relative_errors(out.variance, bounced.irradiance, hits);
  return out;
}

}  // namespace

Result<Gather> gather(const scene::Scene& scene, const atlas::Atlas& atlas,
                      const atlas::TexelMap& map, const transport::Elements& elements,
                      const transport::Lights& lights, const trace::RayTracer& tracer,
                      const GatherParams& params, Progress& progress) {
  const transport::DirectParams direct_params{
      .samples = params.direct_samples, .seed = params.seed, .layers = params.layers};
  const transport::SupersampleParams supersample_params{.points = params.supersample,
                                                        .direct = direct_params};
  LUXEL_TRY(transport::DirectLight direct,
            transport::direct_light(scene, elements, lights, tracer, direct_params, progress));
  LUXEL_TRY(const transport::Supersampled averaged,
            transport::supersample(scene, atlas, map, elements, lights, tracer, supersample_params,
                                   direct, progress));
  direct.rays += averaged.rays;
  const TraceParams trace_params{params.seed, params.hit_memory_bytes, params.scratch_folder,
                                 params.bounces < 0 ? &lights : nullptr, params.layers};
  const std::vector<StoredHit> behind = places_behind(scene, atlas, map, elements);
  LUXEL_TRY(TracedHits hits, trace_hits(scene, atlas, elements, lights.around, tracer,
                                        params.samples, trace_params, progress));
  const transport::TexelScene world{scene, atlas, map, elements, lights, tracer};
  DirectLevels levels{std::vector<uint8_t>(elements.size()), std::vector<uint8_t>(elements.size())};
  for (const uint32_t i : averaged.texels) levels.averaged[i] = 1;
  Bounced bounced;
  Errors errors;
  for (bool last = params.max_error <= 0;;) {
    const float tolerance = last ? params.tolerance : kRoughTolerance;
    LUXEL_TRY(bounced, bounce(map, elements, hits, direct.irradiance, behind,
                              {params.bounces, tolerance}, progress));
    errors = errors_of(atlas, map, direct, bounced, hits);
    if (last) break;
    last = percentile_95(errors.all) <= params.max_error;
    if (last) continue;
    // Of a part that is below half of the square all may be left as it is.
    const float each = params.max_error / std::sqrt(2.0f);
    LUXEL_TRY(const size_t finer, refine_direct(world, errors.direct, each, supersample_params,
                                                levels, direct, progress));
    const std::vector<uint16_t> target =
        next_samples(errors.gathered, each, params.max_samples, hits);
    last = finer == 0 && target == hits.samples;
    if (target == hits.samples) continue;
    LUXEL_TRY_STATUS(trace_more(scene, atlas, elements, lights.around, tracer, target, trace_params,
                                hits, progress));
  }
  Gather out;
  if (params.layers) {
    LUXEL_TRY(LayersBounced layers,
              bounce_layers(map, elements, hits, layer_sources(hits, std::move(direct.by_layer)),
                            behind, bounced, params.bounces < 0, progress));
    out.layers = std::move(layers.irradiance), out.layers_shared_out = layers.shared_out;
  }
  out.relative_error = relative_error(bounced.irradiance, errors.variance);
  out.irradiance = std::move(bounced.irradiance);
  out.direct = std::move(direct.irradiance);
  out.direct_variance = std::move(direct.variance);
  out.indirect_variance = std::move(bounced.split_variance);
  out.pooled_variance = std::move(errors.variance);
  out.relative_error_p95 = percentile_95(errors.all);
  out.errors = std::move(errors.all);
  out.enclosed = find_enclosed(scene, elements, tracer, hits);
  out.met_back = std::move(hits.met_back);
  out.samples = std::move(hits.samples);
  out.rays = direct.rays + hits.rays;
  out.supersampled = averaged.texels.size();
  out.sweeps = bounced.sweeps;
  out.hit_bytes_in_file = hits.bytes_in_file();
  return out;
}

}  // namespace luxel::gather
