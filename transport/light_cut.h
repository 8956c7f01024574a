// Which lights matter at a point: a cut through the light hierarchy. [Walter05]
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "transport/lights.h"

namespace luxel::transport {

/// One entry of a cut: a single triangle, whose unshadowed light is known exactly, or a group of
/// triangles, whose light is only estimated.
struct CutEntry {
  uint32_t node = 0;
  bool exact = false;
  /// Irradiance per unit of radiance, nothing in between: pi F, or 0 for a group.
  float irradiance_per_radiance = 0;
  /// Luminance of the irradiance: exact, or an estimate that is zero only where nothing arrives.
  float importance = 0;
};

/// Replaces the most important group by its two halves until `max_entries` are reached or only
/// single triangles are left, or the groups that are left are negligible, then drops what does not shine on the point. With at most
/// `max_entries` triangle lights every entry is exact.
void light_cut(const Lights& lights, Vec3 position, Vec3 normal, size_t max_entries,
               std::vector<CutEntry>& cut);

/// pi F(point -> triangle light): irradiance per unit of radiance, nothing in between. Zero in the
/// light's own plane and behind a one-sided light.
float irradiance_per_radiance(const TriangleLight& light, Vec3 position, Vec3 normal);

}  // namespace luxel::transport
