#include "luxel/solve/gather/rays/followed_rays.h"

#include <cmath>

namespace luxel::gather {
namespace {

/// A component of a direction is one of 1023 steps, from 1 on: 0 is that of no plain way.
constexpr int kMiddle = 512, kCubeSteps = 511;

uint32_t pack_component(float x) { return uint32_t(kMiddle + int(std::lround(x * kCubeSteps))); }

float unpack_component(uint32_t bits) {
  return float(int(bits & 1023) - kMiddle) * (1.0f / float(kCubeSteps));
}

}  // namespace

FollowedRay FollowedRay::pack(Rgb light, const FollowedWay& way) {
  const uint32_t ends = uint32_t(way.has_hit) << 30 | uint32_t(way.second_half) << 31;
  if (!way.is_plain) return {light, ends};
  const Vec3 d = way.direction;
  return {light,
          ends | pack_component(d.x) | pack_component(d.y) << 10 | pack_component(d.z) << 20};
}

FollowedWay FollowedRay::way() const {
  FollowedWay out;
  out.has_hit = has_hit(), out.second_half = bits >> 31 & 1;
  out.is_plain = (bits & 1023) != 0;
  if (out.is_plain)
    out.direction = {unpack_component(bits), unpack_component(bits >> 10),
                     unpack_component(bits >> 20)};
  return out;
}

}  // namespace luxel::gather
