#include "luxel/light/kept_light.h"

#include <algorithm>

namespace luxel::light {
namespace {

struct KeptLight {
  Rgb irradiance;
  float variance = 0, split_variance = 0;
};

}  // namespace

void add_to(Digest& digest, const LightLayers* layers) {
  if (!layers) return;
  digest.add("layers"), digest.add(layers->size());
  digest.add(std::span(layers->of_triangle)), digest.add(std::span(layers->of_punctual));
  digest.add(int(layers->of_surroundings.value_or(kMaxLayers)));
}

void add_to(Digest& digest, const DirectParams& params) {
  digest.add(params.samples), digest.add(params.seed);
  digest.add(params.same_points), digest.add(params.sky_samples);
  add_to(digest, params.layers);
}

void put_light(const DirectLight& direct, std::span<const uint32_t> which, ByteWriter& out) {
  const size_t layers = direct.by_layer.size() / std::max<size_t>(direct.irradiance.size(), 1);
  for (const uint32_t i : which) {
    out.put_value(KeptLight{direct.irradiance[i], direct.variance[i], direct.split_variance[i]});
    out.put(std::span(direct.by_layer).subspan(i * layers, layers));
  }
}

bool get_light(ByteReader& in, std::span<const uint32_t> which, DirectLight& direct) {
  const size_t layers = direct.by_layer.size() / std::max<size_t>(direct.irradiance.size(), 1);
  if (in.bytes.size() < which.size() * (sizeof(KeptLight) + layers * sizeof(Rgb))) return false;
  for (const uint32_t i : which) {
    const KeptLight light = in.get_value<KeptLight>();
    direct.irradiance[i] = light.irradiance;
    direct.variance[i] = light.variance, direct.split_variance[i] = light.split_variance;
    in.get(std::span(direct.by_layer).subspan(i * layers, layers));
  }
  return true;
}

}  // namespace luxel::light
