#include "luxel/gpu/acceleration.h"

#include "luxel/base/check.h"

namespace luxel::gpu {
namespace {

using BuildInfo = VkAccelerationStructureBuildGeometryInfoKHR;

/// Bytes from an address to the next one that Vulkan takes. `step` is a power of two.
VkDeviceSize to_next(VkDeviceAddress address, VkDeviceSize step) {
  return (step - address % step) % step;
}

/// minAccelerationStructureScratchOffsetAlignment is this at most.
constexpr VkDeviceSize kMostAlignment = 256;

/// The structure in a buffer of its own.
Result<Acceleration> make_structure(const Device& device, VkAccelerationStructureTypeKHR type,
                                    VkDeviceSize size, std::string_view what) {
  Acceleration out;
  LUXEL_TRY(out.buffer, make_buffer(device, size, Access::device, what));
  auto info = structure<VkAccelerationStructureCreateInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR);
  info.buffer = out.buffer.buffer.get();
  info.size = size;
  info.type = type;
  VkAccelerationStructureKHR made = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(
      device.vk.vkCreateAccelerationStructureKHR(device.device, &info, nullptr, &made), what));
  out.structure = {device, made};
  auto asked = structure<VkAccelerationStructureDeviceAddressInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR);
  asked.accelerationStructure = made;
  out.address = device.vk.vkGetAccelerationStructureDeviceAddressKHR(device.device, &asked);
  return out;
}

/// `counts`: of the primitives of each of `geometries`.
Result<Acceleration> build(Commands& commands, VkAccelerationStructureTypeKHR type,
                           std::span<const VkAccelerationStructureGeometryKHR> geometries,
                           std::span<const uint32_t> counts, std::string_view what) {
  const Device& device = commands.device();
  LUXEL_CHECK(device.has_ray_queries && geometries.size() == counts.size());
  auto info =
      structure<BuildInfo>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
  info.type = type;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = uint32_t(geometries.size());
  info.pGeometries = geometries.data();
  auto sizes = structure<VkAccelerationStructureBuildSizesInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR);
  device.vk.vkGetAccelerationStructureBuildSizesKHR(
      device.device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, counts.data(), &sizes);
  LUXEL_TRY(Acceleration out, make_structure(device, type, sizes.accelerationStructureSize, what));
  LUXEL_TRY(const Buffer room,
            make_buffer(device, sizes.buildScratchSize + kMostAlignment, Access::device, what));
  info.dstAccelerationStructure = out.structure.get();
  info.scratchData.deviceAddress = room.address + to_next(room.address, kMostAlignment);
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const uint32_t count : counts) ranges.push_back({count, 0, 0, 0});
  const VkAccelerationStructureBuildRangeInfoKHR* all_ranges = ranges.data();
  LUXEL_TRY_STATUS(commands.run([&](VkCommandBuffer c) {
    device.vk.vkCmdBuildAccelerationStructuresKHR(c, 1, &info, &all_ranges);
    full_barrier(device, c);
  }));
  return out;
}

VkAccelerationStructureGeometryKHR geometry_of(VkGeometryTypeKHR type) {
  auto out = structure<VkAccelerationStructureGeometryKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  out.geometryType = type;
  return out;
}

}  // namespace

Result<Acceleration> accelerate(Commands& commands, std::span<const AcceleratedTriangles> parts,
                                std::string_view what) {
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<uint32_t> counts;
  for (const AcceleratedTriangles& part : parts) {
    auto geometry = geometry_of(VK_GEOMETRY_TYPE_TRIANGLES_KHR);
    geometry.flags = part.are_opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR
                                     : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
    auto& triangles = geometry.geometry.triangles;
    triangles = structure<VkAccelerationStructureGeometryTrianglesDataKHR>(
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR);
    triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    triangles.vertexData.deviceAddress = part.corners;
    triangles.vertexStride = part.bytes_per_corner;
    triangles.maxVertex = part.count > 0 ? 3 * part.count - 1 : 0;
    triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
    geometries.push_back(geometry);
    counts.push_back(part.count);
  }
  return build(commands, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometries, counts, what);
}

Result<Acceleration> accelerate(Commands& commands, std::span<const Placed> placed,
                                std::string_view what) {
  LUXEL_CHECK(placed.size() < (1u << 24));
  LUXEL_TRY(const Buffer there, uploaded_or_one(commands, placed, what));
  auto geometry = geometry_of(VK_GEOMETRY_TYPE_INSTANCES_KHR);
  auto& instances = geometry.geometry.instances;
  instances = structure<VkAccelerationStructureGeometryInstancesDataKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR);
  instances.data.deviceAddress = there.address;
  const uint32_t count(placed.size());
  return build(commands, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {&geometry, 1}, {&count, 1},
               what);
}

}  // namespace luxel::gpu
