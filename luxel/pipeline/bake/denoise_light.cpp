#include "luxel/pipeline/bake/denoise_light.h"

#include "luxel/base/check.h"
#include "luxel/post/denoise.h"

namespace luxel::pipeline {

Status denoise_light(const light::TexelScene& in, TexelLight& light, Progress& progress) {
  LUXEL_CHECK(light.variance.size() == light.irradiance.size());
  const post::TexelGeometry places{in.scene,           in.atlas,    in.map, in.elements.position,
                                   in.elements.normal, light.hidden};
  std::vector<Rgb> rest = light.irradiance;
  // A difference of rounded sums may fall below zero.
  for (size_t i = 0; i < light.direct.size(); ++i)
    rest[i] = max(light.irradiance[i] - light.direct[i], Rgb{});
  std::vector<post::NoisyLight> parts{{rest, light.variance}};
  if (!light.direct.empty()) parts.push_back({light.direct, light.direct_variance, false});
  LUXEL_TRY_STATUS(post::denoise(places, parts, {}, progress));
  for (size_t i = 0; i < light.direct.size(); ++i) rest[i] += light.direct[i];
  light.irradiance = std::move(rest);
  return {};
}

}  // namespace luxel::pipeline
