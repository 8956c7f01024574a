// Surfaces that let light through, as devices know them: masks, blended and transmissive ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/trace/vulkan/binary_hierarchy.h"
#include "luxel/trace/vulkan/device_pictures.h"

namespace luxel::trace {

struct SeeThrough {
  std::vector<on_device::SeeThroughMaterial> materials;
  std::vector<on_device::SeeThroughTriangle> triangles;
  std::vector<uint32_t> texels;  ///< RGBA, red in the lowest byte
};

/// Finds surfaces that let light through. What it is made with must outlive it.
class SeeThroughFinder {
 public:
  SeeThroughFinder(const scene::Scene& scene, SeeThrough& out);
  /// Adds those among `triangles`, which have the numbers of drawn ones, and notes in each where it
  /// is found: DeviceTriangle::see_through.
  void find(std::span<DeviceTriangle> triangles);

 private:
  const scene::Scene& scene_;
  SeeThrough& out_;
  DevicePictures pictures_;
  bool any_;  ///< whether any material lets light through
  std::vector<uint32_t> first_triangle_;
  std::vector<uint32_t> material_there_;  ///< per material: its number in out_
};

}  // namespace luxel::trace
