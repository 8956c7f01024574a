// Pictures on a device: what shaders look up and what they draw into.
#pragma once

#include <cstddef>
#include <span>

#include "luxel/gpu/buffer.h"
#include "luxel/gpu/commands.h"

namespace luxel::gpu {

struct PictureParams {
  VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  uint32_t width = 0, height = 0;
  uint32_t levels = 1;  ///< of mipmaps
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT;
};

struct Picture {
  OwnedMemory memory;
  Owned<VkImage, &VolkDeviceTable::vkDestroyImage> image;
  Owned<VkImageView, &VolkDeviceTable::vkDestroyImageView> view;
  PictureParams params;

  bool is_depth() const { return params.format == VK_FORMAT_D32_SFLOAT; }
  VkImageAspectFlags aspect() const {
    return is_depth() ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  }
};

/// A picture of undefined content. Errors: no memory, larger than the device's pictures may be.
Result<Picture> make_picture(const Device& device, const PictureParams& params,
                             std::string_view what);

/// Mipmap levels down to one pixel.
uint32_t full_levels(uint32_t width, uint32_t height);

/// A picture with these pixels, in whole rows, top row first, to be looked up in shaders. With more
/// than one level the others are means of four pixels of the level before. Formats of 8 bits are
/// averaged as their format says: SRGB in linear light.
Result<Picture> picture_with(Commands& commands, PictureParams params,
                             std::span<const std::byte> pixels, std::string_view what);

/// Pixels of a picture that picture_with() made, instead of those that it has. Nothing may still
/// look it up. Errors: no memory for the copy, the device is lost.
Status put_pixels(Commands& commands, const Picture& picture, std::span<const std::byte> pixels,
                  std::string_view what);

/// Records that, for pixels that lie on the device.
void record_pixels(const Device& device, VkCommandBuffer commands, const Picture& picture,
                   const Buffer& pixels);

/// A colour image, all its mipmaps, goes from one use to another, after all that came before.
void change_layout(const Device& device, VkCommandBuffer commands, VkImage image,
                   VkImageLayout from, VkImageLayout to);
/// A picture, which may be of depth, goes from one use to another.
void change_layout(const Device& device, VkCommandBuffer commands, const Picture& picture,
                   VkImageLayout from, VkImageLayout to);

/// The pixels of level 0, which is in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL; whole rows, top first.
Result<std::vector<std::byte>> pixels_of(Commands& commands, const Picture& picture);

/// Filtering between pixels and addressing beyond edges when shaders look up.
struct SamplerParams {
  VkFilter filter = VK_FILTER_LINEAR;
  VkSamplerAddressMode u = VK_SAMPLER_ADDRESS_MODE_REPEAT, v = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  /// A look-up tells whether a depth is at least the picture's, which is one of depth.
  bool compares_depth = false;
  VkSamplerMipmapMode mipmaps = VK_SAMPLER_MIPMAP_MODE_LINEAR;
};
using OwnedSampler = Owned<VkSampler, &VolkDeviceTable::vkDestroySampler>;
Result<OwnedSampler> make_sampler(const Device& device, const SamplerParams& params);

}  // namespace luxel::gpu
