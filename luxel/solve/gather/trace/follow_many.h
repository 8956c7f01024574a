// Paths of many elements that are followed on (near_paths.h) all together, on a graphics device.
// The processor finds what surfaces reflect, and draws; the device has all rays.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "luxel/light/light_device.h"
#include "luxel/solve/gather/trace/sort_rays.h"

namespace luxel::gather {

/// The device that traces the rays of paths, and lights the places that they meet.
struct PathDevice {
  light::LightDevice& light;
  /// Finds the first hit of each ray. Errors: no memory, the device is lost.
  std::function<Status(std::span<const trace::Ray>, std::span<trace::Hit>)> closest_hits;
};

struct FollowedPaths {
  std::vector<FollowedPath> paths;  ///< by element and ray
  uint64_t rays = 0;
};

/// Takes paths from their near hits to where they end, as follow_paths() does, up to rounding.
/// Where light is not told apart, in scenes without tints. Errors: cancelled; those of the device.
Result<FollowedPaths> follow_many(const RayScene& in, const PathDevice& device,
                                  std::vector<NearPath> paths, TracedHits& hits,
                                  Progress& progress);

}  // namespace luxel::gather
