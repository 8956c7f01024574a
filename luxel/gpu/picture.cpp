#include "luxel/gpu/picture.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "luxel/base/check.h"

namespace luxel::gpu {
namespace {

size_t bytes_per_pixel(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_D32_SFLOAT:
      return 4;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return 8;
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return 16;
    default:
      break;
  }
  LUXEL_CHECK(false && "a format of luxel's");
  return 0;
}

size_t bytes_of(const PictureParams& p) { return bytes_per_pixel(p.format) * p.width * p.height; }

VkImageMemoryBarrier2 barrier_of(VkImage image, VkImageAspectFlags aspect, VkImageLayout from,
                                 VkImageLayout to) {
  auto barrier = structure<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from, barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, 1};
  return barrier;
}

VkImageMemoryBarrier2 barrier_of(const Picture& picture, VkImageLayout from, VkImageLayout to) {
  return barrier_of(picture.image.get(), picture.aspect(), from, to);
}

void put(const Device& device, VkCommandBuffer commands, const VkImageMemoryBarrier2& barrier) {
  auto info = structure<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  device.vk.vkCmdPipelineBarrier2KHR(commands, &info);
}

VkBufferImageCopy whole(const Picture& picture) {
  VkBufferImageCopy copy{};
  copy.imageSubresource = {picture.aspect(), 0, 0, 1};
  copy.imageExtent = {picture.params.width, picture.params.height, 1};
  return copy;
}

/// Each level from the one before it; all are in TRANSFER_DST, and SHADER_READ_ONLY afterwards.
void fill_levels(const Device& device, VkCommandBuffer commands, const Picture& picture) {
  auto size = [&](uint32_t level) {
    return VkOffset3D{int32_t(std::max(1u, picture.params.width >> level)),
                      int32_t(std::max(1u, picture.params.height >> level)), 1};
  };
  for (uint32_t level = 1; level < picture.params.levels; ++level) {
    VkImageMemoryBarrier2 barrier = barrier_of(picture, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    barrier.subresourceRange.baseMipLevel = level - 1, barrier.subresourceRange.levelCount = 1;
    put(device, commands, barrier);
    VkImageBlit blit{};
    blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level - 1, 0, 1};
    blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
    blit.srcOffsets[1] = size(level - 1), blit.dstOffsets[1] = size(level);
    device.vk.vkCmdBlitImage(commands, picture.image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                             picture.image.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit,
                             VK_FILTER_LINEAR);
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    put(device, commands, barrier);
  }
  VkImageMemoryBarrier2 last = barrier_of(picture, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  last.subresourceRange.baseMipLevel = picture.params.levels - 1;
  put(device, commands, last);
}

}  // namespace

uint32_t full_levels(uint32_t width, uint32_t height) {
  return uint32_t(std::bit_width(std::max(width, height)));
}

Result<Picture> make_picture(const Device& device, const PictureParams& params,
                             std::string_view what) {
  LUXEL_CHECK(params.width > 0 && params.height > 0 && params.levels > 0);
  if (std::max(params.width, params.height) > device.limits.maxImageDimension2D)
    return fail(ErrorCode::unsupported,
                "{}: {} x {} pixels are more than {} a side, the limit of {}", what, params.width,
                params.height, device.limits.maxImageDimension2D, device.name);
  Picture out;
  out.params = params;
  auto info = structure<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = params.format;
  info.extent = {params.width, params.height, 1};
  info.mipLevels = params.levels, info.arrayLayers = 1;
  info.samples = params.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = params.usage;
  const std::string cannot = fmt::format("cannot create {}", what);
  VkImage image = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateImage(device.device, &info, nullptr, &image), cannot));
  out.image = {device, image};
  VkMemoryRequirements needed{};
  device.vk.vkGetImageMemoryRequirements(device.device, image, &needed);
  LUXEL_TRY(out.memory, allocate(device, needed, Access::device, what));
  LUXEL_TRY_STATUS(
      check(device.vk.vkBindImageMemory(device.device, image, out.memory.get(), 0), cannot));
  auto view_info = structure<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  view_info.image = image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view_info.format = params.format;
  view_info.subresourceRange = {out.aspect(), 0, params.levels, 0, 1};
  VkImageView view = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      check(device.vk.vkCreateImageView(device.device, &view_info, nullptr, &view), cannot));
  out.view = {device, view};
  return out;
}

void change_layout(const Device& device, VkCommandBuffer commands, VkImage image,
                   VkImageLayout from, VkImageLayout to) {
  put(device, commands, barrier_of(image, VK_IMAGE_ASPECT_COLOR_BIT, from, to));
}

void change_layout(const Device& device, VkCommandBuffer commands, const Picture& picture,
                   VkImageLayout from, VkImageLayout to) {
  put(device, commands, barrier_of(picture, from, to));
}

Result<Picture> picture_with(Commands& commands, PictureParams params,
                             std::span<const std::byte> pixels, std::string_view what) {
  LUXEL_CHECK(pixels.size() == bytes_of(params));
  const Device& device = commands.device();
  params.usage |= VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                  VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  LUXEL_TRY(Picture out, make_picture(device, params, what));
  LUXEL_TRY_STATUS(put_pixels(commands, out, pixels, what));
  return out;
}

Status put_pixels(Commands& commands, const Picture& picture, std::span<const std::byte> pixels,
                  std::string_view what) {
  LUXEL_CHECK(pixels.size() == bytes_of(picture.params));
  const Device& device = commands.device();
  LUXEL_TRY(const Buffer staging, buffer_with(device, pixels, what));
  return commands.run(
      [&](VkCommandBuffer buffer) { record_pixels(device, buffer, picture, staging); });
}

void record_pixels(const Device& device, VkCommandBuffer commands, const Picture& picture,
                   const Buffer& pixels) {
  LUXEL_CHECK(pixels.size == bytes_of(picture.params));
  change_layout(device, commands, picture, VK_IMAGE_LAYOUT_UNDEFINED,
                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  const VkBufferImageCopy copy = whole(picture);
  device.vk.vkCmdCopyBufferToImage(commands, pixels.buffer.get(), picture.image.get(),
                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
  fill_levels(device, commands, picture);
}

Result<std::vector<std::byte>> pixels_of(Commands& commands, const Picture& picture) {
  const Device& device = commands.device();
  LUXEL_TRY(const Buffer read, make_buffer(device, bytes_of(picture.params), Access::to_host,
                                           "the copy of a picture"));
  LUXEL_TRY_STATUS(commands.run([&](VkCommandBuffer buffer) {
    full_barrier(device, buffer);
    const VkBufferImageCopy copy = whole(picture);
    device.vk.vkCmdCopyImageToBuffer(buffer, picture.image.get(),
                                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, read.buffer.get(), 1,
                                     &copy);
    full_barrier(device, buffer);
  }));
  const std::span<const std::byte> bytes = read.bytes();
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<OwnedSampler> make_sampler(const Device& device, const SamplerParams& params) {
  auto info = structure<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  info.magFilter = info.minFilter = params.filter;
  info.mipmapMode = params.mipmaps;
  info.addressModeU = params.u, info.addressModeV = params.v;
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  info.compareEnable = params.compares_depth;
  info.compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL;
  VkSampler sampler = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateSampler(device.device, &info, nullptr, &sampler),
                         "cannot create a sampler"));
  return OwnedSampler(device, sampler);
}

}  // namespace luxel::gpu
