// Shadow rays of an element and what they are worth: what the parts of direct_light share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/light/direct_light.h"
#include "luxel/light/light_draw.h"
#include "luxel/light/light_layers.h"
#include "luxel/light/lights.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::light {

/// The scene that shadow rays cross, and the lights that they aim at.
struct DirectScene {
  const scene::Scene& scene;
  const Lights& lights;
  const trace::RayTracer& tracer;
};

struct Receiver {
  Vec3 position, normal, geometric_normal;  ///< as in transport::Elements
  uint64_t seed = 0;
};

/// The seed of an element's shadow rays.
inline uint64_t seed_of_element(const DirectParams& params, size_t element) {
  return hash64(params.seed, params.same_points ? 0 : element);
}

/// A shadow ray and what its source would bring.
struct ShadowRay {
  uint32_t source = 0;       ///< index into ShadowRayBatch::sources
  float weight = 0;          ///< w: what the source's density does not cancel
  Rgb radiance;              ///< times w
  bool second_half = false;  ///< of the rays planned at its source
};

/// A source of light: a triangle light, a punctual light, or the surroundings.
struct LightId {
  enum class Kind : uint8_t { surroundings, triangle, punctual };
  Kind kind = Kind::surroundings;
  uint32_t index = 0;  ///< into Lights::triangles or Lights::punctual
};

/// The visible share of a source is  sum w V / sum w  over its shadow rays; its light is that share
/// times the exact unshadowed light. Where nothing is exact, light is scale * sum w V.
struct Source {
  float scale = 0;  ///< exact: irradiance per radiance / chance; else 1 / (rays * chance)
  bool exact = false;
  bool drawn = false;  ///< one of many, for its neighbours too; scale is 1 / chance
  uint32_t planned =
      1;  ///< shadow rays; the first and the second half of them are each well spread
  float sum_weight = 0, second_weight = 0;  ///< of all, and of the second half
  uint32_t rays = 0;
  Rgb sum{};
  float sum_luminance2 = 0, second_luminance = 0;
  Rgb tint{1, 1, 1};     ///< multiplies the sum
  float unshadowed = 0;  ///< luminance, for the variance of exact sources
  LightId light{};       ///< where drawn: the one that stands for its neighbours
};

/// Sources and shadow rays of one receiver or a few; buffers that are reused from element to
/// element.
struct ShadowRayBatch {
  std::vector<float> whole;  ///< per triangle light: irradiance per radiance, nothing in between
  LightDraws draws;
  std::vector<Source> sources;
  std::vector<size_t> sources_end;  ///< per receiver: where its sources end
  std::vector<ShadowRay> shadow_rays;
  std::vector<trace::Ray> rays;
  std::vector<Rgb> arriving;  ///< share of each shadow ray's light
};

/// Forgets all receivers, and keeps the memory for the next ones.
inline void clear(ShadowRayBatch& batch) {
  batch.sources.clear(), batch.sources_end.clear(), batch.shadow_rays.clear(), batch.rays.clear();
}

/// Adds a shadow ray that ends at `target`, or, with t_max infinite, goes on for ever. A
/// direction below the receiver's own triangle is blocked by it: it counts, without a ray.
inline void add_shadow_ray(ShadowRayBatch& batch, const Receiver& at, ShadowRay ray, Vec3 direction,
                           float t_max) {
  Source& source = batch.sources[ray.source];
  source.sum_weight += ray.weight;
  ray.second_half = 2 * source.rays >= source.planned;
  if (ray.second_half) source.second_weight += ray.weight;
  ++source.rays;
  if (dot(direction, at.geometric_normal) <= 0) return;
  batch.shadow_rays.push_back(ray);
  batch.rays.push_back({at.position, 0, direction, t_max});
}

/// Each adds what it aims at of one kind, about `samples` shadow rays for it.
void aim_at_triangles(const DirectScene& lit, int samples, const Receiver& r,
                      ShadowRayBatch& batch);
void aim_at_punctual_lights(const Lights& lights, int samples, const Receiver& r,
                            ShadowRayBatch& batch);
/// Bright texels of the environment, in proportion to their power.
void aim_at_bright_texels(const scene::Scene& scene, const Surroundings& around, int samples,
                          const Receiver& r, ShadowRayBatch& batch);
/// The soft light of the surroundings, by rays with the density of the cosine.
void aim_at_soft_sky(const scene::Scene& scene, const Surroundings& around, int samples,
                     const Receiver& r, ShadowRayBatch& batch);

struct LightAt {
  Rgb irradiance{};
  float variance = 0;        ///< estimated, of the luminance, as if shadow rays were independent
  float split_variance = 0;  ///< the same from the halves of each source's shadow rays
};

/// direct_light at a few receivers, whose shadow rays are traced together: `out` gets the light of
/// each. The number of rays is that of batch.rays.
void direct_light_at(const DirectScene& lit, const DirectParams& params,
                     std::span<const Receiver> receivers, ShadowRayBatch& batch,
                     std::span<LightAt> out);

/// That of punctual lights alone, with so many rays for each sun disc.
void punctual_light_at(const DirectScene& lit, int samples, std::span<const Receiver> receivers,
                       ShadowRayBatch& batch, std::span<LightAt> out);

/// Direct light at one receiver.
LightAt direct_light_at(const DirectScene& lit, const DirectParams& params, const Receiver& r,
                        ShadowRayBatch& batch);

/// The light of receiver number `receiver` of the last direct_light_at(), times `factor`, is added
/// to the layer that each source belongs to: `out` has an entry per layer.
void add_light_by_layer(const ShadowRayBatch& batch, size_t receiver, const LightLayers& layers,
                        Rgb factor, std::span<Rgb> out);

}  // namespace luxel::light
