// Light that arrives straight from the sources.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/part_store.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/light/light_layers.h"
#include "luxel/light/lights.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::light {

class LightDevice;

struct DirectParams {
  int samples = 64;  ///< shadow rays per element towards triangle lights, and towards each sun disc
  uint64_t seed = 1;
  /// All elements look at the same points of a light: penumbrae without noise, in steps of
  /// 1 / samples. For solvers whose elements are compared with their neighbours.
  bool same_points = false;
  /// Rays per element towards the soft light of the surroundings. 0: the caller's own rays see it;
  /// the bright texels of an environment count in any case.
  int sky_samples = 0;
  PartStore* parts = nullptr;           ///< where finished parts are kept and found; null: nowhere
  Team* team = nullptr;                 ///< whose members share parts out; null: none
  const LightLayers* layers = nullptr;  ///< null: light is not told apart
};

struct DirectLight {
  std::vector<Rgb> irradiance;  ///< E per element [W/m^2]
  /// Estimated variance of its luminance: as if shadow rays were independent, which stratified ones
  /// beat, and from the difference of their halves, nearly right in the mean, but a single square.
  std::vector<float> variance, split_variance;
  /// With layers: each one's part of the irradiance, layer by layer for each element. They add up
  /// to it but for rounding.
  std::vector<Rgb> by_layer;
  uint64_t rays = 0;

  std::span<Rgb> layers_of(size_t element, const LightLayers& layers) {
    return std::span(by_layer).subspan(element * layers.size(), layers.size());
  }
};
/// Besides those of layers.
inline constexpr uint64_t kDirectBytesPerElement =
    bytes_per_entry(&DirectLight::irradiance, &DirectLight::variance, &DirectLight::split_variance);
inline constexpr uint64_t kDirectLayerBytesPerElement = bytes_per_entry(&DirectLight::by_layer);

/// E at every element from emissive triangles, point, spot and directional lights, bright texels of
/// the environment, and the rest of the surroundings where sky_samples asks for it. Each source's
/// unshadowed irradiance is exact; only the visible share is sampled, so that where a source is
/// seen whole, or not at all, the result has no noise. [Heitz18; docs/method/gather.md]. Errors:
/// cancelled.
Result<DirectLight> direct_light(const scene::Scene& scene, const transport::Elements& elements,
                                 const Lights& lights, const trace::RayTracer& tracer,
                                 const DirectParams& params, Progress& progress);

/// Elements, and the scene and lights that light them.
struct LitElements {
  const scene::Scene& scene;
  const transport::Elements& elements;
  const Lights& lights;
  const trace::RayTracer& tracer;
  /// Lights them where light is not told apart, and sky_samples is 0; parts are kept, but not
  /// looked for. Null: the processor does.
  LightDevice* device = nullptr;
};

/// direct_light() of such elements. Errors: cancelled; those of the device.
Result<DirectLight> direct_light(const LitElements& in, const DirectParams& params,
                                 Progress& progress);

/// The light of some elements again, with other samples, in place of what is there. Errors:
/// cancelled, those of the device; `direct` is of no use then.
Status direct_light_again(const LitElements& in, std::span<const uint32_t> which,
                          const DirectParams& params, DirectLight& direct, Progress& progress);

}  // namespace luxel::light
