#include "luxel/gpu/swapchain.h"

#include <algorithm>

#include "luxel/gpu/picture.h"

namespace luxel::gpu {
namespace {

constexpr const char* kCannotShow = "cannot draw into the window";

Result<VkSurfaceFormatKHR> choose_format(const Device& device, VkSurfaceKHR surface) {
  uint32_t count = 0;
  vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical, surface, &count, nullptr);
  std::vector<VkSurfaceFormatKHR> formats(count);
  vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical, surface, &count, formats.data());
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
    for (const VkSurfaceFormatKHR& format : formats)
      if (format.format == wanted && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
        return format;
  return fail(ErrorCode::no_device, "{}: {} cannot show pictures of 8 bits", kCannotShow,
              device.name);
}

Result<Swapchain::Semaphore> make_semaphore(const Device& device) {
  const auto info = structure<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
  VkSemaphore semaphore = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      check(device.vk.vkCreateSemaphore(device.device, &info, nullptr, &semaphore), kCannotShow));
  return Swapchain::Semaphore(device, semaphore);
}

Status add_pictures(const Device& device, Swapchain& out) {
  uint32_t count = 0;
  device.vk.vkGetSwapchainImagesKHR(device.device, out.chain.get(), &count, nullptr);
  out.images.resize(count);
  LUXEL_TRY_STATUS(check(
      device.vk.vkGetSwapchainImagesKHR(device.device, out.chain.get(), &count, out.images.data()),
      kCannotShow));
  for (const VkImage image : out.images) {
    auto info = structure<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
    info.image = image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = out.format;
    info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImageView view = VK_NULL_HANDLE;
    LUXEL_TRY_STATUS(
        check(device.vk.vkCreateImageView(device.device, &info, nullptr, &view), kCannotShow));
    out.views.emplace_back(device, view);
    LUXEL_TRY(Swapchain::Semaphore ready, make_semaphore(device));
    LUXEL_TRY(Swapchain::Semaphore drawn, make_semaphore(device));
    out.ready.push_back(std::move(ready));
    out.drawn.push_back(std::move(drawn));
  }
  return {};
}

}  // namespace

Result<Surface> Surface::adopt(const Device& device, VkSurfaceKHR surface) {
  Surface out(device, surface);
  VkBool32 is_supported = VK_FALSE;
  vkGetPhysicalDeviceSurfaceSupportKHR(device.physical, device.queue_family, surface,
                                       &is_supported);
  if (!is_supported)
    return fail(ErrorCode::no_device, "{} cannot show pictures in this window", device.name);
  return out;
}

Surface::Surface(Surface&& other) noexcept
    : device_(other.device_), surface_(std::exchange(other.surface_, VK_NULL_HANDLE)) {}

Surface::~Surface() {
  if (surface_ != VK_NULL_HANDLE) vkDestroySurfaceKHR(device_->instance, surface_, nullptr);
}

Result<Swapchain> make_swapchain(const Device& device, const Surface& surface, uint32_t width,
                                 uint32_t height, const Swapchain* earlier) {
  VkSurfaceCapabilitiesKHR can{};
  LUXEL_TRY_STATUS(
      check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical, surface.get(), &can),
            kCannotShow));
  LUXEL_TRY(const VkSurfaceFormatKHR format, choose_format(device, surface.get()));
  Swapchain out;
  out.format = format.format;
  const bool knows_size = can.currentExtent.width != UINT32_MAX;
  out.width = knows_size ? can.currentExtent.width
                         : std::clamp(width, can.minImageExtent.width, can.maxImageExtent.width);
  out.height = knows_size
                   ? can.currentExtent.height
                   : std::clamp(height, can.minImageExtent.height, can.maxImageExtent.height);
  auto info = structure<VkSwapchainCreateInfoKHR>(VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR);
  info.surface = surface.get();
  info.minImageCount = std::max(2u, can.minImageCount + 1);
  if (can.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
  info.imageFormat = format.format, info.imageColorSpace = format.colorSpace;
  info.imageExtent = {out.width, out.height};
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  info.oldSwapchain = earlier ? earlier->chain.get() : VK_NULL_HANDLE;
  VkSwapchainKHR chain = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      check(device.vk.vkCreateSwapchainKHR(device.device, &info, nullptr, &chain), kCannotShow));
  out.chain = {device, chain};
  LUXEL_TRY_STATUS(add_pictures(device, out));
  return out;
}

Result<std::optional<NextPicture>> next_picture(const Device& device, Swapchain& swapchain) {
  NextPicture out;
  out.semaphores.wait_for = swapchain.ready[swapchain.turn].get();
  const VkResult result =
      device.vk.vkAcquireNextImageKHR(device.device, swapchain.chain.get(), UINT64_MAX,
                                      out.semaphores.wait_for, VK_NULL_HANDLE, &out.number);
  if (result == VK_ERROR_OUT_OF_DATE_KHR) return std::optional<NextPicture>();
  LUXEL_TRY_STATUS(check(result, kCannotShow));
  swapchain.turn = (swapchain.turn + 1) % swapchain.ready.size();
  out.semaphores.signal = swapchain.drawn[out.number].get();
  return std::optional(out);
}

Result<bool> show(const Device& device, const Swapchain& swapchain, uint32_t number) {
  auto info = structure<VkPresentInfoKHR>(VK_STRUCTURE_TYPE_PRESENT_INFO_KHR);
  const VkSemaphore drawn = swapchain.drawn[number].get();
  const VkSwapchainKHR chain = swapchain.chain.get();
  info.waitSemaphoreCount = 1, info.pWaitSemaphores = &drawn;
  info.swapchainCount = 1, info.pSwapchains = &chain;
  info.pImageIndices = &number;
  const std::lock_guard lock(device.queue_mutex);
  const VkResult result = device.vk.vkQueuePresentKHR(device.queue, &info);
  if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) return false;
  LUXEL_TRY_STATUS(check(result, kCannotShow));
  return true;
}

void copy_to_window(const Device& device, VkCommandBuffer commands, VkImage from, uint32_t width,
                    uint32_t height, const Swapchain& swapchain, uint32_t number) {
  const VkImage to = swapchain.images[number];
  change_layout(device, commands, to, VK_IMAGE_LAYOUT_UNDEFINED,
                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  VkImageBlit blit{};
  blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {int32_t(width), int32_t(height), 1};
  blit.dstOffsets[1] = {int32_t(swapchain.width), int32_t(swapchain.height), 1};
  device.vk.vkCmdBlitImage(commands, from, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
  change_layout(device, commands, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
}

}  // namespace luxel::gpu
