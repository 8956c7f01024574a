// All that rays on a graphics device go through: triangles of the world, and below them meshes that
// several instances share.
#pragma once

#include <array>
#include <string_view>

#include "luxel/base/result.h"
#include "luxel/trace/vulkan/see_through.h"
#include "luxel/trace/vulkan/wide_hierarchy.h"

namespace luxel::trace {

/// Kinds of hierarchy into which triangles are sorted.
enum class HierarchyKind : uint8_t {
  binary,  ///< two children a node, with boxes of floats
  wide,    ///< eight, with boxes of bytes
  driver,  ///< as the driver likes it (driver_hierarchy.h): VK_KHR_ray_query
};
/// "binary", "wide", "driver"
std::string_view name_of(HierarchyKind kind);

/// Where an instance of a shared mesh stands; it takes the place of two triangles. In the mesh's
/// own space no triangle is mirrored.
struct DeviceInstance {
  Mat34 object_from_world;
  uint32_t root = 0;          ///< node of the mesh
  uint32_t first_number = 0;  ///< of its triangles, in the numbering of scene::first_triangles()
  uint32_t instance = 0;
  std::array<uint32_t, 9> unused{};
};
static_assert(sizeof(DeviceInstance) == 2 * sizeof(DeviceTriangle));

/// In DeviceTriangle::mirrored: it stands for an instance. `number` is the triangle whose place a
/// DeviceInstance has; a and b are the instance's box in the world.
inline constexpr uint32_t kStandsForInstance = 2;

struct DeviceHierarchy {
  // One is empty, by the kind.
  std::vector<BinaryNode> binary;
  std::vector<WideNode> wide;
  /// Those of the world, in the order of the leaves; of shared meshes, numbered from 0 on in each;
  /// and DeviceInstances.
  std::vector<DeviceTriangle> triangles;
  SeeThrough see_through;
  bool has_instances = false;
};

/// Binary or wide. Errors: those of stored_triangles().
Result<DeviceHierarchy> device_hierarchy(const scene::Scene& scene, HierarchyKind kind,
                                         size_t max_flat_triangles);

}  // namespace luxel::trace
