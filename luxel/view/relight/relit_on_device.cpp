#include "luxel/view/relight/relit_on_device.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/clock.h"
#include "luxel/view/relight/relit_map_shared.h"
#include "luxel/view/shaders/relit_map.comp.h"

namespace luxel::view {
namespace {

constexpr std::string_view kWhat = "the buffer of the lightmap";

using on_device::kMapThreads, on_device::MapPush;

/// Sends some numbers; their buffer is held. Returns its address.
Result<VkDeviceAddress> send(gpu::Commands& commands, std::span<const uint32_t> numbers,
                             RelitOnDevice& out) {
  LUXEL_TRY(gpu::Buffer buffer, gpu::uploaded_or_one(commands, numbers, kWhat));
  out.held.push_back(std::move(buffer));
  return out.held.back().address;
}

/// Pixels that no place reaches stay black.
Result<VkDeviceAddress> black_pixels(gpu::Commands& commands, RelitOnDevice& out) {
  const std::vector<Rgb> black(out.pixel_count);
  LUXEL_TRY(gpu::Buffer buffer, gpu::uploaded_or_one(commands, black, kWhat));
  out.held.push_back(std::move(buffer));
  return out.held.back().address;
}

Status make_map(gpu::Commands& commands, const MapPlaces& places, const DeviceScene& scene,
                RelitOnDevice& out) {
  const gpu::Device& device = commands.device();
  LUXEL_TRY(out.largest, gpu::make_buffer(device, sizeof(uint32_t), gpu::Access::device, kWhat));
  LUXEL_TRY(out.halves, gpu::make_buffer(device, size_t(out.pixel_count) * 4 * sizeof(uint16_t),
                                         gpu::Access::device, kWhat));
  on_device::RelitMap map{};
  map.light = out.relighter.indirect_at_points(), map.largest = out.largest.address;
  map.halves = out.halves.address, map.pixel_count = out.pixel_count;
  // The scale of the first page's first picture is the first one.
  map.scale = scene.light_now.address + sizeof(on_device::LightNow);
  LUXEL_TRY(map.place, send(commands, places.place, out));
  LUXEL_TRY(map.pixel, send(commands, places.pixel, out));
  LUXEL_TRY(map.gutter, send(commands, places.gutter, out));
  LUXEL_TRY(map.first, send(commands, places.first, out));
  LUXEL_TRY(map.from, send(commands, places.from, out));
  LUXEL_TRY(map.pixels, black_pixels(commands, out));
  LUXEL_TRY(out.map, gpu::uploaded(commands, std::as_bytes(std::span(&map, 1)), kWhat));
  return {};
}

/// Records a step for [begin, end), after all that came before.
void record(const gpu::Device& device, VkCommandBuffer c, const RelitOnDevice& relit, uint32_t step,
            uint32_t begin, uint32_t end) {
  gpu::full_barrier(device, c);
  const uint32_t most = device.limits.maxComputeWorkGroupCount[0] * kMapThreads;
  for (; begin < end; begin += std::min(most, end - begin)) {
    const uint32_t count = std::min(most, end - begin);
    gpu::bind(device, c, relit.steps[step], MapPush{relit.map.address, begin, end});
    device.vk.vkCmdDispatch(c, (count + kMapThreads - 1) / kMapThreads, 1, 1);
  }
}

/// Records what makes the lightmap of the places' light.
void record_map(const gpu::Device& device, VkCommandBuffer c, const RelitOnDevice& relit,
                const gpu::Picture& lightmap) {
  device.vk.vkCmdFillBuffer(c, relit.largest.buffer.get(), 0, VK_WHOLE_SIZE, 0);
  record(device, c, relit, on_device::kMapPlaces, 0, relit.place_count);
  uint32_t begin = 0;
  for (const uint32_t end : relit.ring_end) {
    record(device, c, relit, on_device::kMapGutter, begin, end);
    begin = end;
  }
  record(device, c, relit, on_device::kMapLargest, 0, relit.pixel_count);
  record(device, c, relit, on_device::kMapHalves, 0, relit.pixel_count);
  gpu::full_barrier(device, c);
  gpu::record_pixels(device, c, lightmap, relit.halves);
}

}  // namespace

Result<RelitOnDevice> make_relit_on_device(gpu::Commands& commands, const RelitLight& light,
                                           const DeviceScene& scene) {
  const MapPlaces& places = light.places;
  LUXEL_CHECK(scene.lights[0].size() == 1);
  LUXEL_CHECK(scene.lights[0][0]->params.width == uint32_t(places.width) &&
              scene.lights[0][0]->params.height == uint32_t(places.height));
  LUXEL_TRY(device::DeviceRelighter relighter,
            device::DeviceRelighter::make(commands.device(), light.relighter.data()));
  RelitOnDevice out{.relighter = std::move(relighter)};
  out.place_count = uint32_t(places.place.size());
  out.pixel_count = uint32_t(places.width) * uint32_t(places.height);
  out.ring_end = places.ring_end;
  for (uint32_t step = 0; step < out.steps.size(); ++step) {
    LUXEL_TRY(out.steps[step], gpu::make_compute_pipeline(commands.device(), relit_map_comp,
                                                          {sizeof(MapPush), {}}, {step}));
  }
  LUXEL_TRY_STATUS(make_map(commands, places, scene, out));
  return out;
}

Result<RelitLight::Milliseconds> relight_on_device(gpu::Commands& commands, const Lamps& lamps,
                                                   RelitOnDevice& relit, DeviceScene& scene) {
  const std::vector<scene::PunctualLight> punctual = shining(lamps);
  const std::vector<Rgb> emission = glowing(lamps);
  LUXEL_TRY_STATUS(relit.relighter.update({punctual, emission, lamps.background, {}}));
  const Clock::time_point start = Clock::now();
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer c) { record_map(commands.device(), c, relit, *scene.lights[0][0]); }));
  return RelitLight::Milliseconds{.bounces = 1e3 * relit.relighter.seconds(),
                                  .map = 1e3 * seconds_since(start)};
}

}  // namespace luxel::view
