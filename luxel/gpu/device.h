// A graphics device that draws and computes. This room knows no radiometry.
//
// luxel asks for Vulkan 1.2 with dynamic rendering and synchronization2, and reads buffers in
// shaders by their addresses: then a shader needs no bindings but those of its textures. Functions
// of a device are called through its own table, `vk`, so that several devices may be open.
#pragma once

#include <volk.h>

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "luxel/base/result.h"

namespace luxel::gpu {

/// The choice of a device, and how it is opened.
struct DeviceParams {
  std::string name;  ///< a part of it, in small or capital letters; empty: the fastest kind
  std::optional<uint32_t> number;  ///< instead of a name: that of list_devices(), from 0 on
  /// Without a name or a number: whether it may be software that runs on the processor.
  bool may_be_software = true;
  bool validate = false;  ///< with Vulkan's validation layer: Device::messages()
  /// Vulkan extensions that a window needs (glfwGetRequiredInstanceExtensions); empty: nothing is
  /// shown.
  std::vector<std::string> window_extensions;
};

/// A device of this machine.
struct DeviceInfo {
  std::string name;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  std::string lacks;  ///< what luxel needs and it has not; empty: luxel can use it
  bool has_ray_queries = false;
};

/// The devices of this machine, fastest kind first: discrete, integrated, virtual, the processor.
/// Errors: no Vulkan, or no device (ErrorCode::no_device).
Result<std::vector<DeviceInfo>> list_devices();

/// Holds a device and what it was opened with. Everything made on it must end before it does.
class Device {
 public:
  /// Errors (ErrorCode::no_device): no Vulkan, no device of that name or number or none that has
  /// what luxel needs, no validation layer where it is asked for.
  static Result<std::unique_ptr<Device>> open(const DeviceParams& params);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// The memory type that has all `wanted` properties among those of `type_bits`; UINT32_MAX: none.
  uint32_t memory_type(uint32_t type_bits, VkMemoryPropertyFlags wanted) const;
  /// Errors and warnings of the validation layer so far. May be called while others record.
  std::vector<std::string> messages() const;

  std::string name;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  VkPhysicalDeviceLimits limits{};
  bool has_doubles = false;      ///< whether shaders may compute in double precision
  bool has_ray_queries = false;  ///< whether it has acceleration.h, and shaders may trace by it
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< draws, computes, copies; its users lock queue_mutex
  uint32_t queue_family = 0;
  VolkDeviceTable vk{};
  mutable std::mutex queue_mutex;

 private:
  Device() = default;
  Status open_instance(const DeviceParams& params);
  Status choose(const DeviceParams& params);
  Status open_device(const DeviceParams& params);

  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDeviceMemoryProperties memory_{};
  mutable std::mutex messages_mutex_;
  std::vector<std::string> messages_;

  friend VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT*, void*);
};

/// One of Vulkan's structures of parameters, all zero but its type.
template <class T>
T structure(VkStructureType type) {
  T out{};
  out.sType = type;
  return out;
}

/// Success, or a sentence that begins with `what`, as "the picture cannot be made": no memory, the
/// device is lost, or Vulkan's own word for it.
Status check(VkResult result, std::string_view what);

/// Owns an object of a device. `destroy` is the member of VolkDeviceTable that ends it.
template <class Handle, auto destroy>
class Owned {
 public:
  Owned() = default;
  Owned(const Device& device, Handle handle) : device_(&device), handle_(handle) {}
  Owned(Owned&& other) noexcept { *this = std::move(other); }
  Owned& operator=(Owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Owned() {
    if (handle_ != VK_NULL_HANDLE) (device_->vk.*destroy)(device_->device, handle_, nullptr);
  }

  Handle get() const { return handle_; }

 private:
  const Device* device_ = nullptr;
  Handle handle_ = VK_NULL_HANDLE;
};

}  // namespace luxel::gpu
