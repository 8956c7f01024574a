#include "luxel/view/draw/inset.h"

#include <algorithm>
#include <span>

#include "luxel/base/check.h"
#include "luxel/view/draw/inset_shared.h"
#include "luxel/view/shaders/inset.frag.h"
#include "luxel/view/shaders/inset.vert.h"

namespace luxel::view {
namespace {

constexpr uint32_t kInsetMargin = 8;  ///< to the picture's edges [pixels]

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
  params.interface.push_bytes = sizeof(on_device::InsetPush);
  params.colors = {color};
  params.blends = true;
  return gpu::make_draw_pipeline(device, params);
}

void draw_inset(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                const DeviceInset& inset, uint32_t width, uint32_t height) {
  const auto begin = [](uint32_t size, uint32_t room) {
    return room > size + kInsetMargin ? room - size - kInsetMargin : 0;
  };
  const on_device::InsetPush push{
      .pixels = inset.pixels.address,
      .corner = {begin(inset.width, width), begin(inset.height, height)},
      .size = {inset.width, inset.height},
      .picture = {float(width), float(height)}};
  gpu::bind(device, commands, shader, push);
  device.vk.vkCmdDraw(commands, 6, 1, 0, 0);
}

}  // namespace luxel::view
