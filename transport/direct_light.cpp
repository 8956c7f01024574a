#include "transport/direct_light.h"

#include <algorithm>
#include <atomic>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "transport/direct_shots.h"

namespace luxel::transport {
namespace {

/// Variance of what systematic sampling has drawn: half the mean square of the differences between
/// neighbours on the line, which share their place and differ by chance [Wolter85, eq. 7.2.4].
struct DrawnVariance {
  float before = 0, squares = 0;
  uint32_t count = 0;

  void add(float light) {
    const float d = light - before;
    if (count > 0) squares += 0.5f * d * d;
    before = light, ++count;
  }
  float sum() const {
    if (count < 2) return before * before;
    return squares * float(count) / float(count - 1);
  }
};

/// Traces the shots and adds up what arrives in their sources.
void trace_shots(const trace::RayTracer& tracer, Shots& shots) {
  shots.arriving.resize(shots.rays.size());
  tracer.transmitted(shots.rays, shots.arriving);
  for (size_t k = 0; k < shots.shots.size(); ++k) {
    if (max_component(shots.arriving[k]) <= 0) continue;
    const Shot& shot = shots.shots[k];
    Source& source = shots.sources[shot.source];
    const Rgb arrived = shot.radiance * shots.arriving[k];
    source.sum += arrived;
    const float l = luminance(arrived);
    source.sum_luminance2 += l * l;
  }
}

LightAt sum_of(std::span<const Source> sources) {
  LightAt out;
  DrawnVariance drawn;
  for (const Source& s : sources) {
    if (s.drawn) drawn.add(luminance(s.sum * s.tint) * s.scale);
    if (s.shots == 0 || s.sum_weight <= 0) continue;
    const float n = float(s.shots);
    const Rgb light = s.sum * s.tint * (s.exact ? s.scale / s.sum_weight : s.scale);
    out.irradiance += light;
    if (s.drawn) continue;
    if (s.exact) {
      const float share = std::min(1.0f, luminance(light) / std::max(s.unshadowed, 1e-30f));
      out.variance += s.unshadowed * s.unshadowed * share * (1 - share) / n;
    } else {
      const float mean = luminance(s.sum) / n, mean2 = s.sum_luminance2 / n;
      out.variance += std::max(0.0f, mean2 - mean * mean) * s.scale * s.scale * n;
    }
  }
  out.variance += drawn.sum();
  return out;
}

}  // namespace

void direct_light_at(const scene::Scene& scene, const Lights& lights,
                     const trace::RayTracer& tracer, const DirectParams& params,
                     std::span<const Receiver> receivers, float diagonal_m, Shots& shots,
                     std::span<LightAt> out) {
  LUXEL_CHECK(out.size() == receivers.size());
  shots.sources.clear(), shots.sources_end.clear(), shots.shots.clear(), shots.rays.clear();
  for (const Receiver& r : receivers) {
    shoot_at_triangles(scene, lights, params.samples, r, diagonal_m, shots);
    shoot_at_lamps(lights, params.samples, r, shots);
    shoot_at_peaks(scene, lights.around, params.samples, r, shots);
    shoot_at_soft_sky(scene, lights.around, params.sky_samples, r, shots);
    shots.sources_end.push_back(shots.sources.size());
  }
  trace_shots(tracer, shots);
  const std::span<const Source> sources = shots.sources;
  for (size_t i = 0, begin = 0; i < out.size(); begin = shots.sources_end[i++])
    out[i] = sum_of(sources.subspan(begin, shots.sources_end[i] - begin));
}

LightAt direct_light_at(const scene::Scene& scene, const Lights& lights,
                        const trace::RayTracer& tracer, const DirectParams& params,
                        const Receiver& r, float diagonal_m, Shots& shots) {
  LightAt out;
  direct_light_at(scene, lights, tracer, params, {&r, 1}, diagonal_m, shots, {&out, 1});
  return out;
}

Result<DirectLight> direct_light(const scene::Scene& scene, const Elements& elements,
                                 const Lights& lights, const trace::RayTracer& tracer,
                                 const DirectParams& params, Progress& progress) {
  LUXEL_CHECK(params.samples >= 1);
  DirectLight out;
  out.irradiance.resize(elements.size());
  out.variance.resize(elements.size());
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::atomic<uint64_t> rays{0};
  progress.begin("direct light", elements.size());
  parallel_for(elements.size(), 256, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    Shots shots;
    uint64_t traced = 0;
    for (size_t i = begin; i < end; ++i) {
      const Receiver r{
          elements.position[i], elements.normal[i], elements.geometric_normal[i],
          trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m),
          hash64(params.seed, params.same_points ? 0 : i)};
      const LightAt light = direct_light_at(scene, lights, tracer, params, r, diagonal_m, shots);
      out.irradiance[i] = light.irradiance, out.variance[i] = light.variance;
      traced += shots.rays.size();
    }
    rays += traced;
    progress.advance(end - begin);
  });
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  out.rays = rays;
  return out;
}

}  // namespace luxel::transport
