// The pictures that a window shows in turn.
#pragma once

#include <optional>
#include <vector>

#include "luxel/gpu/commands.h"
#include "luxel/gpu/device.h"

namespace luxel::gpu {

/// The surface that a window draws on. Ends before the device and the window do.
class Surface {
 public:
  /// Takes `surface` over. Errors (no_device): the device cannot show pictures in this window.
  static Result<Surface> adopt(const Device& device, VkSurfaceKHR surface);
  Surface(Surface&& other) noexcept;
  Surface& operator=(Surface&&) = delete;
  ~Surface();
  VkSurfaceKHR get() const { return surface_; }

 private:
  Surface(const Device& device, VkSurfaceKHR surface) : device_(&device), surface_(surface) {}
  const Device* device_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
};

struct Swapchain {
  Owned<VkSwapchainKHR, &VolkDeviceTable::vkDestroySwapchainKHR> chain;
  VkFormat format = VK_FORMAT_UNDEFINED;  ///< 8 bits per channel, display values as they are
  uint32_t width = 0, height = 0;
  std::vector<VkImage> images;
  std::vector<Owned<VkImageView, &VolkDeviceTable::vkDestroyImageView>> views;
  using Semaphore = Owned<VkSemaphore, &VolkDeviceTable::vkDestroySemaphore>;
  std::vector<Semaphore> ready;  ///< to be drawn into, in turn
  std::vector<Semaphore> drawn;  ///< of each picture
  size_t turn = 0;
};

/// As large as the window is, or else as `width` x `height`; shown at the display's rate. Nothing
/// may still draw into an earlier one of this surface, which ends.
Result<Swapchain> make_swapchain(const Device& device, const Surface& surface, uint32_t width,
                                 uint32_t height, const Swapchain* earlier = nullptr);

/// A picture to draw into, and what its drawing waits for and tells.
struct NextPicture {
  uint32_t number = 0;
  Commands::WindowSemaphores semaphores;
};
/// None when the window has changed: a new swapchain is to be made.
Result<std::optional<NextPicture>> next_picture(const Device& device, Swapchain& swapchain);
/// Shows it. False when the window has changed.
Result<bool> show(const Device& device, const Swapchain& swapchain, uint32_t number);

/// Copies a picture that is in TRANSFER_SRC_OPTIMAL over all of one of the window's, which is
/// COLOR_ATTACHMENT_OPTIMAL afterwards.
void copy_to_window(const Device& device, VkCommandBuffer commands, VkImage from, uint32_t width,
                    uint32_t height, const Swapchain& swapchain, uint32_t number);

}  // namespace luxel::gpu
