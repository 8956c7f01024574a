#include "luxel/solve/device/device_sweep.h"

#include <cstring>

#include "luxel/base/check.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/shaders/sweep.comp.h"

namespace luxel::device {
namespace {

/// Push in sweep.comp.
struct SweepPush {
  VkDeviceAddress map, hits, more, ends, gathered;
  uint32_t element_count, samples, map_stride;
  uint32_t first_tile, first_group = 0;
  uint32_t unused = 0;
};
static_assert(sizeof(SweepPush) == 64);

Status make_room(const gpu::Device& device, const gather::RadiosityMap& map, LandedRays& rays) {
  if (rays.gathered.size == 0) {
    LUXEL_TRY(rays.sweep, gpu::make_compute_pipeline(device, sweep_comp, {sizeof(SweepPush), {}}));
    const size_t bytes = rays.element_count * sizeof(DeviceGathered);
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
                     std::span<DeviceGathered> out) {
  LUXEL_CHECK(out.size() == rays.element_count);
  LUXEL_TRY_STATUS(make_room(commands.device(), map, rays));
  std::memcpy(rays.map_sent.mapped, map.texels.data(), rays.map_sent.size);
  LUXEL_TRY_STATUS(gpu::copy_bytes(commands, rays.map_sent, rays.map, rays.map.size));
  double seconds = 0;
  for (const LandedChunk& chunk : rays.chunks) {
    const SweepPush push{.map = rays.map.address,
                         .hits = chunk.hits.address,
                         .more = rays.more.address,
                         .ends = rays.ends.address,
                         .gathered = rays.gathered.address,
                         .element_count = uint32_t(rays.element_count),
                         .samples = rays.samples,
                         .map_stride = map.stride,
                         .first_tile = uint32_t(chunk.first_tile)};
    LUXEL_TRY(const double took,
              gpu::run_groups(commands, rays.sweep, push, chunk.tile_count, rays.sweep_piece));
    seconds += took;
  }
  LUXEL_TRY_STATUS(gpu::copy_bytes(commands, rays.gathered, rays.to_host, rays.gathered.size));
  std::memcpy(out.data(), rays.to_host.mapped, rays.gathered.size);
  return seconds;
}

}  // namespace luxel::device
