// Work that is recorded and given to a device.
#pragma once

#include <cstring>
#include <deque>
#include <functional>
#include <ranges>
#include <vector>

#include "luxel/gpu/buffer.h"

namespace luxel::gpu {

/// Records command buffers and gives them to the device's queue, in order. Each has a number; the
/// device has done all up to the number that its timeline semaphore shows. One thread uses one
/// Commands; several may work on one device.
class Commands {
 public:
  static Result<Commands> make(const Device& device);
  Commands(Commands&&) = default;
  Commands& operator=(Commands&&) = default;
  /// Waits for what was given.
  ~Commands();

  using Record = std::function<void(VkCommandBuffer)>;

  /// Semaphores that a window's picture waits for and signals when it is done; null: none.
  struct WindowSemaphores {
    VkSemaphore wait_for = VK_NULL_HANDLE;
    VkSemaphore signal = VK_NULL_HANDLE;
  };

  /// Records and gives to the device; the number to wait for. Errors: the device is lost.
  Result<uint64_t> submit(const Record& record, WindowSemaphores window);
  Result<uint64_t> submit(const Record& record) { return submit(record, {}); }
  /// Returns when everything up to this number is done. Errors: the device is lost.
  Status wait(uint64_t number);
  /// submit() and wait().
  Status run(const Record& record);

  const Device& device() const { return *device_; }

 private:
  explicit Commands(const Device& device) : device_(&device) {}
  Result<VkCommandBuffer> next_buffer();

  struct Given {
    uint64_t number;
    VkCommandBuffer buffer;
  };
  const Device* device_;
  Owned<VkCommandPool, &VolkDeviceTable::vkDestroyCommandPool> pool_;
  Owned<VkSemaphore, &VolkDeviceTable::vkDestroySemaphore> timeline_;
  uint64_t last_ = 0;
  std::deque<Given> given_;
};

/// All that came before is done and seen by all that comes after, the processor too. Simple, and as
/// fast as anything for the few passes of a frame.
void full_barrier(const Device& device, VkCommandBuffer commands);

/// Copies the first `bytes` of a buffer, after all that came before; all that comes after sees
/// them. Errors: the device is lost.
Status copy_bytes(Commands& commands, const Buffer& from, const Buffer& to, VkDeviceSize bytes);

/// A buffer of the device's own memory with these bytes, which shaders read faster than one that
/// the processor writes. Not empty. Errors: no memory, the device is lost.
Result<Buffer> uploaded(Commands& commands, std::span<const std::byte> bytes,
                        std::string_view what);

/// The first `count` values of a buffer of the device, of which there may be none. Errors: no
/// memory, the device is lost.
template <class T>
Result<std::vector<T>> downloaded(Commands& commands, const Buffer& from, size_t count,
                                  std::string_view what) {
  std::vector<T> out(count);
  if (count == 0) return out;
  LUXEL_TRY(const Buffer here,
            make_buffer(commands.device(), count * sizeof(T), Access::to_host, what));
  LUXEL_TRY_STATUS(copy_bytes(commands, from, here, here.size));
  std::memcpy(out.data(), here.mapped, here.size);
  return out;
}

/// uploaded() for values of which there may be none: the buffer holds a Value{} then, because a
/// buffer is never empty. Errors: no memory, the device is lost.
template <std::ranges::contiguous_range Values>
Result<Buffer> uploaded_or_one(Commands& commands, const Values& values, std::string_view what) {
  using Value = std::ranges::range_value_t<Values>;
  const Value none{};
  std::span<const Value> sent = values;
  if (sent.empty()) sent = {&none, 1};
  return uploaded(commands, std::as_bytes(sent), what);
}

}  // namespace luxel::gpu
