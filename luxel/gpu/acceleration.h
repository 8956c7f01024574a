// Hierarchies that the driver makes for rays in shaders: VK_KHR_acceleration_structure. Only for
// devices that have ray queries (Device::has_ray_queries).
#pragma once

#include <span>

#include "luxel/gpu/commands.h"

namespace luxel::gpu {

/// A hierarchy of triangles, or of such hierarchies where they stand.
struct Acceleration {
  Buffer buffer;  ///< ends after `structure`, which lies in it
  Owned<VkAccelerationStructureKHR, &VolkDeviceTable::vkDestroyAccelerationStructureKHR> structure;
  VkDeviceAddress address = 0;  ///< what shaders and Placed get
};

/// Triangles of three corners after each other, each three floats; none: count 0.
struct AcceleratedTriangles {
  VkDeviceAddress corners = 0;
  uint32_t count = 0;
  uint32_t bytes_per_corner = 0;
  bool are_opaque = true;  ///< if not, shaders are asked about each that a ray may meet
};

/// Where a hierarchy of triangles stands. Vulkan's own structure; transform is row by row, as
/// Mat34.
using Placed = VkAccelerationStructureInstanceKHR;

/// `parts` are its geometries, numbered from 0 on. `what` names it in messages. Errors: no memory,
/// the device is lost.
Result<Acceleration> accelerate(Commands& commands, std::span<const AcceleratedTriangles> parts,
                                std::string_view what);

/// A hierarchy of instances, of none to 2^24 - 1. Errors: as above.
Result<Acceleration> accelerate(Commands& commands, std::span<const Placed> placed,
                                std::string_view what);

}  // namespace luxel::gpu
