// Exact light that was computed before.
#pragma once

#include <unordered_map>

#include "luxel/solve/hierarchical/irradiance.h"

namespace luxel::hierarchical {

/// By places of faces that are the same bit by bit.
struct KnownLight {
  struct Key {
    uint32_t face = 0;
    DVec3 place;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    size_t operator()(const Key& key) const;
  };
  std::unordered_map<Key, Rgb, Hash> at;
};
/// All light but that of sharp lights; what is not known yet is from then on. One E per
/// receiver [W/m^2]. Errors: cancelled.
Result<std::vector<Rgb>> continuous_irradiance_at(
    const Solution& solution, const scene::Scene& scene, const trace::RayTracer& tracer,
    std::span<const Receiver> receivers, PointParams params, KnownLight& known, Progress& progress);

}  // namespace luxel::hierarchical
