// Memory of a device that shaders read and write.
#pragma once

#include <cstddef>
#include <span>

#include "luxel/gpu/device.h"

namespace luxel::gpu {

using OwnedMemory = Owned<VkDeviceMemory, &VolkDeviceTable::vkFreeMemory>;

/// Parties that touch a buffer's bytes.
enum class Access : uint8_t {
  device,     ///< the device alone; filled by a copy on it
  from_host,  ///< written by the processor, read by the device
  to_host,    ///< written by the device, read by the processor
};

/// Bytes of a device. Usable as anything but pictures: by address in shaders, as indices, for
/// copies, for indirect calls. Each has an allocation of its own, of which drivers give some 4000.
struct Buffer {
  OwnedMemory memory;  ///< ends after `buffer`, which lies in it
  Owned<VkBuffer, &VolkDeviceTable::vkDestroyBuffer> buffer;
  VkDeviceSize size = 0;
  VkDeviceAddress address = 0;  ///< what shaders get
  std::byte* mapped = nullptr;  ///< `size` bytes; null for Access::device

  std::span<std::byte> bytes() const { return {mapped, mapped ? size_t(size) : 0}; }
};

/// Errors: no memory. `what` names it in messages: "the buffer of triangles". size > 0.
Result<Buffer> make_buffer(const Device& device, VkDeviceSize size, Access access,
                           std::string_view what);

/// One that the device reads, with these bytes, written before it returns. Not empty.
Result<Buffer> buffer_with(const Device& device, std::span<const std::byte> bytes,
                           std::string_view what);

/// Memory for a buffer or picture. Errors: none left.
Result<OwnedMemory> allocate(const Device& device, const VkMemoryRequirements& needed,
                             Access access, std::string_view what);

}  // namespace luxel::gpu
