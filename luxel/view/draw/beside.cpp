#include "luxel/view/draw/beside.h"

#include <array>

#include "luxel/base/check.h"
#include "luxel/image/color.h"
#include "luxel/image/flip.h"
#include "luxel/view/draw/beside_shared.h"
#include "luxel/view/model/look.h"

namespace luxel::view {
namespace {

/// All that put_together() looks up.
std::array<const gpu::Picture*, 4> pictures_of(const Painter& first, const Painter& second) {
  return {&first.shown.picture, &second.shown.picture, &first.exposed.picture,
          &second.exposed.picture};
}

/// Frames that are compared show light.
Frame compared(const Frame& frame) {
  Frame out = frame;
  if (frame.beside->mode == BesideMode::difference && looks_into_bake(frame.show))
    out.show = Show::light;
  return out;
}

/// Display values as linear light.
image::Image linear_of(std::span<const std::byte> pixels, const gpu::TargetParams& size) {
  image::Image out(int(size.width), int(size.height), 3);
  for (size_t i = 0; i < out.data.size(); ++i)
    out.data[i] = image::linear_from_srgb(float(uint8_t(pixels[4 * (i / 3) + i % 3])) / 255);
  return out;
}

}  // namespace

Result<Pair> make_pair(gpu::Commands& commands, const Shaders& shaders, const Painter& first,
                       const DeviceScene& second) {
  const gpu::Device& device = commands.device();
  const gpu::TargetParams& size = first.shown.params;
  Pair out;
  LUXEL_TRY(out.second, make_painter(device, shaders, second, size.width, size.height));
  LUXEL_TRY(out.shown, gpu::make_target(device, size, "both pictures"));
  const auto colors = packed_false_colors();
  LUXEL_TRY(out.colors,
            gpu::buffer_with(device, std::as_bytes(std::span(colors)), "false colours"));
  gpu::PictureParams params;
  params.width = size.width, params.height = size.height;
  const std::vector<std::byte> black(size_t(size.width) * size.height * 4);
  LUXEL_TRY(out.flip, gpu::picture_with(commands, params, black, "the map of FLIP"));
  std::vector<gpu::Binding> bindings;
  for (const gpu::Picture* picture : pictures_of(first, out.second))
    bindings.push_back({picture, first.sampler.get()});
  bindings.push_back({&out.flip, first.sampler.get()});
  const std::vector<std::vector<gpu::Binding>> sets{bindings};
  LUXEL_TRY(out.sets, gpu::make_sets(device, shaders.beside, sets));
  return out;
}

void paint_both(const gpu::Device& device, VkCommandBuffer commands, const Canvas& first,
                const Canvas& second, const Frame& frame) {
  LUXEL_CHECK(frame.beside.has_value());
  paint(device, commands, first, compared(frame));
  paint(device, commands, second, compared(frame));
}

void put_together(const gpu::Device& device, VkCommandBuffer commands, const Canvas& first,
                  const Pair& pair, const Frame& frame) {
  constexpr auto kRead = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  constexpr auto kCopied = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  const auto pictures = pictures_of(first.painter, pair.second);
  for (const gpu::Picture* picture : pictures)
    gpu::change_layout(device, commands, *picture, kCopied, kRead);
  gpu::begin_drawing(device, commands, pair.shown, {0, 0, 0, 1});
  const on_device::BesidePush push{pair.colors.address, uint32_t(frame.beside->mode),
                                   frame.beside->split * float(pair.shown.params.width),
                                   kMostDifference};
  gpu::bind(device, commands, first.shaders.beside, push);
  gpu::bind_set(device, commands, first.shaders.beside, pair.sets.sets[0]);
  device.vk.vkCmdDraw(commands, 3, 1, 0, 0);
  gpu::end_drawing(device, commands, pair.shown, kCopied);
  for (const gpu::Picture* picture : pictures)
    gpu::change_layout(device, commands, *picture, kRead, kCopied);
}

Result<float> compare(gpu::Commands& commands, const Painter& first, const Pair& pair) {
  LUXEL_TRY(const std::vector<std::byte> a, gpu::pixels_of(commands, first.shown.picture));
  LUXEL_TRY(const std::vector<std::byte> b, gpu::pixels_of(commands, pair.second.shown.picture));
  const gpu::TargetParams& size = first.shown.params;
  const image::Image map = image::flip(linear_of(a, size), linear_of(b, size));
  const auto colors = packed_false_colors();
  std::vector<uint32_t> shown;
  double sum = 0;
  for (const float v : map.data) {
    sum += double(v);
    shown.push_back(colors[size_t(v * 255 + 0.5f)] | 0xff000000);
  }
  LUXEL_TRY_STATUS(
      gpu::put_pixels(commands, pair.flip, std::as_bytes(std::span(shown)), "the map of FLIP"));
  return float(sum / double(map.data.size()));
}

Result<image::Image8> painted_together(gpu::Commands& commands, const Canvas& first,
                                       const Canvas& second, const Pair& pair, const Frame& frame) {
  const gpu::Device& device = commands.device();
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer buffer) { paint_both(device, buffer, first, second, frame); }));
  if (frame.beside->mode == BesideMode::flip)
    LUXEL_TRY_STATUS(compare(commands, first.painter, pair).map([](float) {}));
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer buffer) { put_together(device, buffer, first, pair, frame); }));
  return shown_pixels(commands, pair.shown);
}

}  // namespace luxel::view
