#include "luxel/light/kept_light.h"

namespace luxel::light {
namespace {

struct KeptLight {
  Rgb irradiance;
  float variance = 0, split_variance = 0;
};

}  // namespace

void add_to(Digest& digest, const DirectParams& params) {
  digest.add(params.samples), digest.add(params.seed);
  digest.add(params.same_points), digest.add(params.sky_samples);
}

void put_light(const DirectLight& direct, std::span<const uint32_t> which, ByteWriter& out) {
  for (const uint32_t i : which)
    out.put_value(KeptLight{direct.irradiance[i], direct.variance[i], direct.split_variance[i]});
}

bool get_light(ByteReader& in, std::span<const uint32_t> which, DirectLight& direct) {
  if (in.bytes.size() < which.size() * sizeof(KeptLight)) return false;
  for (const uint32_t i : which) {
    const KeptLight light = in.get_value<KeptLight>();
    direct.irradiance[i] = light.irradiance;
    direct.variance[i] = light.variance, direct.split_variance[i] = light.split_variance;
  }
  return true;
}

}  // namespace luxel::light
