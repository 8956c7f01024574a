// Triangles as drivers take them, whose hierarchy is their own: VK_KHR_acceleration_structure.
#pragma once

#include <array>

#include "luxel/gpu/acceleration.h"
#include "luxel/trace/vulkan/see_through.h"

namespace luxel::trace {

/// Triangles near each other, in the world or in the space of a mesh that instances share. The
/// driver makes a hierarchy of each part. Numbers are those in DriverHierarchy::triangles.
struct DriverPart {
  uint32_t first = 0, first_open = 0, end = 0;  ///< from first_open on they let light through
};

/// A part where it stands; it takes the place of a triangle.
struct DriverInstance {
  uint32_t first = 0, first_open = 0;  ///< of its part
  uint32_t first_number = 0;           ///< of its triangles, in the numbering of first_triangles()
  uint32_t instance = 0;               ///< of a shared mesh; in the world scene::kNone
  std::array<uint32_t, 8> unused{};
};
static_assert(sizeof(DriverInstance) == sizeof(DeviceTriangle));

struct DriverHierarchy {
  std::vector<DeviceTriangle> triangles;  ///< DriverInstances, then those of the parts
  std::vector<DriverPart> parts;
  /// Where parts stand, in the order of DriverInstances. `accelerationStructureReference` is the
  /// number of the part.
  std::vector<gpu::Placed> places;
  SeeThrough see_through;
  bool has_instances = false;
};

/// Triangles of a part at most: so few that no driver should be busy with one for long. Not
/// measured.
inline constexpr size_t kMostInPart = size_t(1) << 21;

/// Errors: those of stored_triangles(), 2^24 instances or more (ErrorCode::unsupported).
Result<DriverHierarchy> driver_hierarchy(const scene::Scene& scene, size_t max_flat_triangles,
                                         size_t most_in_part = kMostInPart);

/// Acceleration structures that the driver builds of a DriverHierarchy.
struct DriverAcceleration {
  std::vector<gpu::Acceleration> parts;
  gpu::Acceleration world;  ///< of the parts, where they stand
};

/// `triangles` has DriverHierarchy::triangles; it must outlive what is made. Errors: more than a
/// thousand parts (ErrorCode::unsupported), no memory, the device is lost.
Result<DriverAcceleration> accelerate(gpu::Commands& commands, const DriverHierarchy& hierarchy,
                                      const gpu::Buffer& triangles);

}  // namespace luxel::trace
