#include "luxel/light/direct_light.h"

#include <algorithm>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/job.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/light/kept_light.h"
#include "luxel/light/light_device.h"
#include "luxel/light/shadow_rays.h"

namespace luxel::light {
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

/// Traces the shadow rays and adds up what arrives in their sources.
void trace_batch(const trace::RayTracer& tracer, ShadowRayBatch& batch) {
  batch.arriving.resize(batch.rays.size());
  tracer.transmitted(batch.rays, batch.arriving);
  for (size_t k = 0; k < batch.shadow_rays.size(); ++k) {
    if (max_component(batch.arriving[k]) <= 0) continue;
    const ShadowRay& ray = batch.shadow_rays[k];
    Source& source = batch.sources[ray.source];
    const Rgb arrived = ray.radiance * batch.arriving[k];
    source.sum += arrived;
    const float l = luminance(arrived);
    source.sum_luminance2 += l * l;
    if (ray.second_half) source.second_luminance += l;
  }
}

Rgb light_of(const Source& s) {
  return s.sum * s.tint * (s.exact ? s.scale / s.sum_weight : s.scale);
}

/// As if its shadow rays were independent.
float variance_of(const Source& s, float light) {
  const float n = float(s.rays);
  if (s.exact) {
    const float share = std::min(1.0f, light / std::max(s.unshadowed, 1e-30f));
    return s.unshadowed * s.unshadowed * share * (1 - share) / n;
  }
  const float mean = luminance(s.sum) / n, mean2 = s.sum_luminance2 / n;
  return std::max(0.0f, mean2 - mean * mean) * s.scale * s.scale * n;
}

/// ((A - B) / 2)^2 of the light by either half of its shadow rays. `whole` where there are no
/// halves.
float split_variance_of(const Source& s, float light, float whole) {
  const float sum = luminance(s.sum), first_weight = s.sum_weight - s.second_weight;
  if (!(first_weight > 0) || !(s.second_weight > 0) || !(sum > 0)) return whole;
  const float a = s.exact ? (sum - s.second_luminance) / first_weight * s.sum_weight
                          : 2 * (sum - s.second_luminance);
  const float b =
      s.exact ? s.second_luminance / s.second_weight * s.sum_weight : 2 * s.second_luminance;
  const float half = 0.5f * (a - b) / sum * light;
  return half * half;
}

size_t layer_of(const LightLayers& layers, LightId light) {
  switch (light.kind) {
    case LightId::Kind::triangle:
      return layers.of_triangle[light.index];
    case LightId::Kind::punctual:
      return layers.of_punctual[light.index];
    case LightId::Kind::surroundings:
      break;
  }
  LUXEL_CHECK(layers.of_surroundings.has_value());
  return *layers.of_surroundings;
}

LightAt sum_of(std::span<const Source> sources) {
  LightAt out;
  DrawnVariance drawn;
  for (const Source& s : sources) {
    if (s.drawn) drawn.add(luminance(s.sum * s.tint) * s.scale);
    if (s.rays == 0 || s.sum_weight <= 0) continue;
    const Rgb light = light_of(s);
    out.irradiance += light;
    if (s.drawn) continue;
    const float variance = variance_of(s, luminance(light));
    out.variance += variance;
    out.split_variance += split_variance_of(s, luminance(light), variance);
  }
  out.variance += drawn.sum(), out.split_variance += drawn.sum();
  return out;
}

/// The light of receivers at which `aim` aims, one after the other.
template <class Aim>
void light_at(const trace::RayTracer& tracer, std::span<const Receiver> receivers,
              ShadowRayBatch& batch, std::span<LightAt> out, const Aim& aim) {
  LUXEL_CHECK(out.size() == receivers.size());
  clear(batch);
  for (const Receiver& r : receivers) {
    aim(r);
    batch.sources_end.push_back(batch.sources.size());
  }
  trace_batch(tracer, batch);
  const std::span<const Source> sources = batch.sources;
  for (size_t i = 0, begin = 0; i < out.size(); begin = batch.sources_end[i++])
    out[i] = sum_of(sources.subspan(begin, batch.sources_end[i] - begin));
}

}  // namespace

void direct_light_at(const DirectScene& lit, const DirectParams& params,
                     std::span<const Receiver> receivers, ShadowRayBatch& batch,
                     std::span<LightAt> out) {
  const Lights& lights = lit.lights;
  light_at(lit.tracer, receivers, batch, out, [&](const Receiver& r) {
    aim_at_triangles(lit, params.samples, r, batch);
    aim_at_punctual_lights(lights, params.samples, r, batch);
    aim_at_bright_texels(lit.scene, lights.around, params.samples, r, batch);
    aim_at_soft_sky(lit.scene, lights.around, params.sky_samples, r, batch);
  });
}

void punctual_light_at(const DirectScene& lit, int samples, std::span<const Receiver> receivers,
                       ShadowRayBatch& batch, std::span<LightAt> out) {
  light_at(lit.tracer, receivers, batch, out,
           [&](const Receiver& r) { aim_at_punctual_lights(lit.lights, samples, r, batch); });
}

void add_light_by_layer(const ShadowRayBatch& batch, size_t receiver, const LightLayers& layers,
                        Rgb factor, std::span<Rgb> out) {
  LUXEL_CHECK(out.size() == layers.size());
  const size_t begin = receiver == 0 ? 0 : batch.sources_end[receiver - 1];
  for (size_t k = begin; k < batch.sources_end[receiver]; ++k) {
    const Source& s = batch.sources[k];
    if (s.rays == 0 || s.sum_weight <= 0) continue;
    out[layer_of(layers, s.light)] += light_of(s) * factor;
  }
}

LightAt direct_light_at(const DirectScene& lit, const DirectParams& params, const Receiver& r,
                        ShadowRayBatch& batch) {
  LightAt out;
  direct_light_at(lit, params, {&r, 1}, batch, {&out, 1});
  return out;
}

namespace {

/// Elements of a part, which a checkpoint keeps: large enough to be written seldom.
constexpr size_t kPartElements = 256;

KeptStage kept_stage(const DirectParams& params, std::span<const uint32_t> which) {
  if (params.parts == nullptr) return {};
  Digest digest;
  digest.add("direct light"), add_to(digest, params), digest.add(which);
  return {params.parts, digest.value()};
}

/// The parts of some of the elements, but for what finds their light.
PartWork parts_of(std::span<const uint32_t> which, DirectLight& direct) {
  const auto elements_of = [which](size_t part) {
    const size_t begin = part * kPartElements;
    return which.subspan(begin, std::min(kPartElements, which.size() - begin));
  };
  PartWork out;
  out.count = (which.size() + kPartElements - 1) / kPartElements;
  out.units = [=](size_t part) { return elements_of(part).size(); };
  out.put = [=, &direct](size_t part, ByteWriter& to) { put_light(direct, elements_of(part), to); };
  out.get = [=, &direct](size_t part, ByteReader& from) {
    return get_light(from, elements_of(part), direct);
  };
  return out;
}

Receiver receiver_of(const transport::Elements& elements, size_t i, const DirectParams& params) {
  return {elements.position[i], elements.normal[i], elements.geometric_normal[i],
          seed_of_element(params, i)};
}

void set_light(size_t element, const LightAt& light, DirectLight& direct) {
  direct.irradiance[element] = light.irradiance;
  direct.variance[element] = light.variance;
  direct.split_variance[element] = light.split_variance;
}

/// direct_light_again() by the device, whose parts are kept for the processor. Errors: as that.
Status light_again_on_device(const LitElements& in, std::span<const uint32_t> which,
                             const DirectParams& params, DirectLight& direct, Progress& progress) {
  constexpr size_t kAtATime = size_t(1) << 18;  // 20 MB, and 18 MB for the device
  static_assert(kAtATime % kPartElements == 0);
  const KeptStage kept = kept_stage(params, which);
  const PartWork parts = parts_of(which, direct);
  std::vector<Receiver> receivers;
  std::vector<LightAt> light;
  progress.begin("direct light", which.size());
  for (size_t first = 0; first < which.size(); first += kAtATime) {
    const auto these = which.subspan(first, std::min(kAtATime, which.size() - first));
    receivers.resize(these.size()), light.resize(these.size());
    parallel_for(these.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k)
        receivers[k] = receiver_of(in.elements, these[k], params);
    });
    LUXEL_TRY(const uint64_t rays,
              in.device->light_at(receivers, {.samples = params.samples}, light, progress));
    for (size_t k = 0; k < these.size(); ++k) set_light(these[k], light[k], direct);
    direct.rays += rays;
    // Every part gets a share of the rays.
    for (size_t k = first; k < first + these.size(); k += kPartElements)
      keep_part(kept, parts, k / kPartElements,
                rays * parts.units(k / kPartElements) / these.size());
    progress.advance(these.size());
  }
  return stopped(progress);
}

}  // namespace

namespace {

/// Looks at the direct light of some elements again.
struct LookAgain {
  const LitElements& in;
  const DirectParams& params;
  DirectScene lit;
  DirectLight& direct;

  uint64_t look(std::span<const uint32_t> these) const;
};

/// One receiver after the other: its light, the variance of it, and the share of each layer.
/// Returns the number of rays.
uint64_t LookAgain::look(std::span<const uint32_t> these) const {
  ShadowRayBatch batch;
  uint64_t traced = 0;
  for (const uint32_t i : these) {
    const Receiver receiver = receiver_of(in.elements, i, params);
    set_light(i, direct_light_at(lit, params, receiver, batch), direct);
    if (params.layers) {
      const std::span<Rgb> own = direct.layers_of(i, *params.layers);
      std::ranges::fill(own, Rgb{});
      add_light_by_layer(batch, 0, *params.layers, {1, 1, 1}, own);
    }
    traced += batch.rays.size();
  }
  return traced;
}

}  // namespace

Status direct_light_again(const LitElements& in, std::span<const uint32_t> which,
                          const DirectParams& params, DirectLight& direct, Progress& progress) {
  LUXEL_CHECK(params.samples >= 1 && direct.irradiance.size() == in.elements.size());
  LUXEL_CHECK(direct.by_layer.size() ==
              (params.layers ? params.layers->size() : 0) * in.elements.size());
  if (in.device && !params.layers && params.sky_samples == 0)
    return light_again_on_device(in, which, params, direct, progress);
  const LookAgain again{in, params, {in.scene, in.lights, in.tracer}, direct};
  PartWork parts = parts_of(which, direct);
  parts.compute = [&](size_t part) {
    return again.look(which.subspan(part * kPartElements, parts.units(part)));
  };
  progress.begin("direct light", which.size());
  LUXEL_TRY(const uint64_t rays,
            for_each_part({progress, kept_stage(params, which), params.team}, parts));
  direct.rays += rays;
  return {};
}

Result<DirectLight> direct_light(const LitElements& in, const DirectParams& params,
                                 Progress& progress) {
  const size_t n = in.elements.size();
  DirectLight out;
  out.irradiance.resize(n), out.variance.resize(n), out.split_variance.resize(n);
  if (params.layers) out.by_layer.resize(n * params.layers->size());
  std::vector<uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  LUXEL_TRY_STATUS(direct_light_again(in, all, params, out, progress));
  return out;
}

Result<DirectLight> direct_light(const scene::Scene& scene, const transport::Elements& elements,
                                 const Lights& lights, const trace::RayTracer& tracer,
                                 const DirectParams& params, Progress& progress) {
  return direct_light({scene, elements, lights, tracer}, params, progress);
}

}  // namespace luxel::light
