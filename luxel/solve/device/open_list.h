// The list into which a device writes the rays that it leaves to the processor.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/device/land_shared.h"
#include "luxel/solve/gather/trace/open_rays.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::device {

/// Has room for some rays. The device counts those that find none, too.
struct OpenList {
  gpu::Buffer rays, to_host;  ///< the count, the capacity, and as many on_device::OpenRay
  uint32_t capacity = 0;
};

/// Errors: no memory.
Result<OpenList> make_open_list(const gpu::Device& device, uint64_t capacity);

/// Empties the list.
void record_emptying(const gpu::Device& device, VkCommandBuffer commands, const OpenList& list);

/// The number of rays that the device has left open: more than the capacity, if some found no room.
/// Errors: the device is lost.
Result<uint32_t> open_count(gpu::Commands& commands, const OpenList& list);

/// The first `count` rays of the list, in any order. Errors: the device is lost.
Result<std::vector<on_device::OpenRay>> read_open(gpu::Commands& commands, const OpenList& list,
                                                  uint32_t count);

/// Rays of elements [begin, end), in the order of elements, and of each element's rays: the same
/// each time.
std::vector<gather::OpenRay> in_order(std::span<const on_device::OpenRay> open, size_t begin,
                                      size_t end, const trace::DeviceRayTracer& tracer);

}  // namespace luxel::device
