#include "luxel/solve/device/device_sweep.h"

#include <cstring>

#include "luxel/base/check.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/shaders/sweep.comp.h"

namespace luxel::device {
namespace {

using on_device::SweepPush;

Status make_room(const gpu::Device& device, const gather::RadiosityMap& map, LandedRays& rays) {
  if (rays.gathered.size == 0) {
    LUXEL_TRY(rays.sweep, gpu::make_compute_pipeline(device, sweep_comp, {sizeof(SweepPush), {}}));
    const size_t bytes = rays.element_count * sizeof(on_device::Gathered);
    LUXEL_TRY(rays.gathered,
              gpu::make_buffer(device, bytes, gpu::Access::device, "the buffer of gathered light"));
    LUXEL_TRY(rays.to_host, gpu::make_buffer(device, bytes, gpu::Access::to_host,
                                             "the buffer of gathered light"));
  }
  const size_t bytes = map.texels.size() * sizeof(gather::Float4);
  if (rays.map.size == bytes) return {};
  LUXEL_TRY(rays.map_sent,
            gpu::make_buffer(device, bytes, gpu::Access::from_host, "the buffer of the map"));
  LUXEL_TRY(rays.map,
            gpu::make_buffer(device, bytes, gpu::Access::device, "the buffer of the map"));
  return {};
}

}  // namespace

Result<double> sweep(gpu::Commands& commands, LandedRays& rays, const gather::RadiosityMap& map,
                     std::span<on_device::Gathered> out) {
  LUXEL_CHECK(out.size() == rays.element_count);
  LUXEL_TRY_STATUS(make_room(commands.device(), map, rays));
  std::memcpy(rays.map_sent.mapped, map.texels.data(), rays.map_sent.size);
  LUXEL_TRY_STATUS(gpu::copy_bytes(commands, rays.map_sent, rays.map, rays.map.size));
  LUXEL_TRY_STATUS(commands.run([&](VkCommandBuffer c) {
    gpu::full_barrier(commands.device(), c);
    commands.device().vk.vkCmdFillBuffer(c, rays.gathered.buffer.get(), 0, VK_WHOLE_SIZE, 0);
  }));
  SweepPush push{};
  push.map = rays.map.address, push.map_stride = map.stride;
  push.gathered = rays.gathered.address, push.counted = rays.counted_rounds.address;
  double seconds = 0;
  for (const LandedRound& round : rays.rounds) {
    push.more = round.more.address, push.ends = round.ends.address;
    for (const LandedChunk& chunk : round.chunks) {
      push.slots = chunk.slots.address, push.rows = chunk.first_row.address;
      push.hits = chunk.hits.address, push.slot_count = uint32_t(chunk.slot_count);
      LUXEL_TRY(const double took,
                gpu::run_groups(commands, rays.sweep, push, chunk.tile_count, rays.sweep_piece));
      seconds += took;
    }
    ++push.round;
  }
  LUXEL_TRY_STATUS(gpu::copy_bytes(commands, rays.gathered, rays.to_host, rays.gathered.size));
  std::memcpy(out.data(), rays.to_host.mapped, rays.gathered.size);
  return seconds;
}

}  // namespace luxel::device
