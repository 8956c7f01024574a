#include "luxel/gpu/buffer.h"

#include <cstring>

#include "luxel/base/check.h"

namespace luxel::gpu {
namespace {

/// Properties that a memory type should have, best first.
std::vector<VkMemoryPropertyFlags> wishes(Access access) {
  constexpr VkMemoryPropertyFlags kHost =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  switch (access) {
    case Access::device:
      return {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
    case Access::from_host:
      return {kHost | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, kHost};
    case Access::to_host:
      return {kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kHost};
  }
  return {};
}

}  // namespace

Result<OwnedMemory> allocate(const Device& device, const VkMemoryRequirements& needed,
                             Access access, std::string_view what) {
  auto flags = structure<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  auto info = structure<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  info.pNext = &flags;
  info.allocationSize = needed.size;
  VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  for (const VkMemoryPropertyFlags wish : wishes(access)) {
    info.memoryTypeIndex = device.memory_type(needed.memoryTypeBits, wish);
    if (info.memoryTypeIndex == UINT32_MAX) continue;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    result = device.vk.vkAllocateMemory(device.device, &info, nullptr, &memory);
    if (result == VK_SUCCESS) return OwnedMemory(device, memory);
  }
  return Failure{
      check(result, fmt::format("cannot create {} ({} MB)", what, needed.size >> 20)).error()};
}

Result<Buffer> make_buffer(const Device& device, VkDeviceSize size, Access access,
                           std::string_view what) {
  LUXEL_CHECK(size > 0);
  auto info = structure<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = size;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
               VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (device.has_ray_queries)
    info.usage |= VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                  VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR;
  Buffer out;
  out.size = size;
  VkBuffer buffer = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateBuffer(device.device, &info, nullptr, &buffer),
                         fmt::format("cannot create {}", what)));
  out.buffer = {device, buffer};
  VkMemoryRequirements needed{};
  device.vk.vkGetBufferMemoryRequirements(device.device, buffer, &needed);
  LUXEL_TRY(out.memory, allocate(device, needed, access, what));
  const VkDeviceMemory memory = out.memory.get();
  LUXEL_TRY_STATUS(check(device.vk.vkBindBufferMemory(device.device, buffer, memory, 0), what));
  auto address = structure<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
  address.buffer = buffer;
  out.address = device.vk.vkGetBufferDeviceAddress(device.device, &address);
  if (access == Access::device) return out;
  void* mapped = nullptr;
  LUXEL_TRY_STATUS(
      check(device.vk.vkMapMemory(device.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), what));
  out.mapped = static_cast<std::byte*>(mapped);
  return out;
}

Result<Buffer> buffer_with(const Device& device, std::span<const std::byte> bytes,
                           std::string_view what) {
  LUXEL_TRY(Buffer out, make_buffer(device, bytes.size(), Access::from_host, what));
  std::memcpy(out.mapped, bytes.data(), bytes.size());
  return out;
}

}  // namespace luxel::gpu
