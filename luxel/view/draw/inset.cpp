#include "luxel/view/draw/inset.h"

#include <algorithm>
#include <span>

#include "luxel/base/check.h"
#include "luxel/base/vec.h"
#include "luxel/view/shaders/inset.frag.h"
#include "luxel/view/shaders/inset.vert.h"

namespace luxel::view {
namespace {

constexpr uint32_t kInsetMargin = 8;  ///< to the picture's edges [pixels]

/// The push constants of shaders/inset.glsl, in scalar layout.
struct InsetPush {
  VkDeviceAddress pixels = 0;
  uint32_t x = 0, y = 0, width = 0, height = 0;
  Vec2 picture;
};
static_assert(sizeof(InsetPush) == 32);

}  // namespace

Result<DeviceInset> put_inset(const gpu::Device& device, const image::Image8& picture) {
  LUXEL_CHECK(picture.channels == 4 && !picture.data.empty());
  DeviceInset out{{}, uint32_t(picture.width), uint32_t(picture.height)};
  LUXEL_TRY(out.pixels, gpu::buffer_with(device, std::as_bytes(std::span(picture.data)),
                                         "the picture in the corner"));
  return out;
}

Result<gpu::Pipeline> make_inset_shader(const gpu::Device& device, VkFormat color) {
  gpu::DrawParams params;
  params.vertex = inset_vert, params.fragment = inset_frag;
  params.interface.push_bytes = sizeof(InsetPush);
  params.colors = {color};
  params.blends = true;
  return gpu::make_draw_pipeline(device, params);
}

void draw_inset(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                const DeviceInset& inset, uint32_t width, uint32_t height) {
  const auto begin = [](uint32_t size, uint32_t room) {
    return room > size + kInsetMargin ? room - size - kInsetMargin : 0;
  };
  InsetPush push{
      inset.pixels.address, begin(inset.width, width),    begin(inset.height, height), inset.width,
      inset.height,         {float(width), float(height)}};
  gpu::bind(device, commands, shader, push);
  device.vk.vkCmdDraw(commands, 6, 1, 0, 0);
}

}  // namespace luxel::view
