// A small picture over a picture, in one of its corners.
#pragma once

#include "luxel/gpu/pipeline.h"
#include "luxel/image/codec.h"

namespace luxel::view {

/// A picture on a device, pixel for pixel as it is shown.
struct DeviceInset {
  gpu::Buffer pixels;
  uint32_t width = 0, height = 0;
};

/// `picture` has 4 channels and is not empty. Errors: no memory on the device.
Result<DeviceInset> put_inset(const gpu::Device& device, const image::Image8& picture);

/// For pictures of this format, of one sample per pixel and without depth.
Result<gpu::Pipeline> make_inset_shader(const gpu::Device& device, VkFormat color);

/// In the right lower corner of a picture of this size, as much of it as there is room for.
void draw_inset(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                const DeviceInset& inset, uint32_t width, uint32_t height);

}  // namespace luxel::view
