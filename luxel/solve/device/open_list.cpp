#include "luxel/solve/device/open_list.h"

#include <algorithm>
#include <cstring>

#include "luxel/base/parallel.h"

namespace luxel::device {
Result<OpenList> make_open_list(const gpu::Device& device, uint64_t capacity) {
  const uint64_t bytes = sizeof(on_device::OpenRays) + capacity * sizeof(on_device::OpenRay);
  constexpr std::string_view kWhat = "the buffer of rays that the processor ends";
  OpenList out;
  LUXEL_TRY(out.rays, gpu::make_buffer(device, bytes, gpu::Access::device, kWhat));
  LUXEL_TRY(out.to_host, gpu::make_buffer(device, bytes, gpu::Access::to_host, kWhat));
  out.capacity = uint32_t(capacity);
  return out;
}

void record_emptying(const gpu::Device& device, VkCommandBuffer commands, const OpenList& list) {
  const on_device::OpenRays head{0, list.capacity};
  device.vk.vkCmdUpdateBuffer(commands, list.rays.buffer.get(), 0, sizeof head, &head);
}

Result<uint32_t> open_count(gpu::Commands& commands, const OpenList& list) {
  LUXEL_TRY_STATUS(gpu::copy_bytes(commands, list.rays, list.to_host, sizeof(on_device::OpenRays)));
  on_device::OpenRays head;
  std::memcpy(&head, list.to_host.mapped, sizeof head);
  return head.count;
}

Result<std::vector<on_device::OpenRay>> read_open(gpu::Commands& commands, const OpenList& list,
                                                  uint32_t count) {
  std::vector<on_device::OpenRay> out(count);
  if (count == 0) return out;
  const size_t bytes = count * sizeof(on_device::OpenRay);
  LUXEL_TRY_STATUS(
      gpu::copy_bytes(commands, list.rays, list.to_host, sizeof(on_device::OpenRays) + bytes));
  std::memcpy(out.data(), list.to_host.mapped + sizeof(on_device::OpenRays), bytes);
  return out;
}

std::vector<gather::OpenRay> in_order(std::span<const on_device::OpenRay> open, size_t begin,
                                      size_t end, const trace::DeviceRayTracer& tracer) {
  const size_t n = end - begin;
  std::vector<size_t> first(n + 1);
  for (const on_device::OpenRay& ray : open) ++first[ray.element - begin + 1];
  for (size_t i = 0; i < n; ++i) first[i + 1] += first[i];
  std::vector<uint32_t> order(open.size());
  std::vector<size_t> next = first;
  for (uint32_t k = 0; k < open.size(); ++k) order[next[open[k].element - begin]++] = k;
  std::vector<gather::OpenRay> out(open.size());
  parallel_for(n, 1024, [&](size_t from, size_t to) {
    for (size_t i = from; i < to; ++i) {
      const auto own = std::span(order).subspan(first[i], first[i + 1] - first[i]);
      std::ranges::sort(own, {}, [&](uint32_t k) { return open[k].place; });
      for (size_t at = first[i]; at < first[i + 1]; ++at) {
        const on_device::OpenRay& ray = open[order[at]];
        out[at] = {ray.element, ray.sample_number, ray.doublings, tracer.hit_of(ray.hit)};
      }
    }
  });
  return out;
}

}  // namespace luxel::device
