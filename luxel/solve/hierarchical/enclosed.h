// Points inside of solids, where light means nothing.
#pragma once

#include <span>
#include <vector>

#include "luxel/trace/ray_tracer.h"

namespace luxel::hierarchical {

/// Per point 1 where it sees backs of one-sided surfaces with more than half of its rays. Only
/// points that are dark are looked at: a back sends nothing.
std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   std::span<const Vec3> position, std::span<const Vec3> normal,
                                   std::span<const Rgb> irradiance);

}  // namespace luxel::hierarchical
