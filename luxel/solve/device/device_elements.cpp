#include "luxel/solve/device/device_elements.h"

#include "luxel/base/parallel.h"

namespace luxel::device {
Result<gpu::Buffer> upload_elements(gpu::Commands& commands, const transport::Elements& elements) {
  std::vector<on_device::Element> values(elements.size());
  parallel_for(values.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      values[i] = {elements.position[i], elements.normal[i], elements.geometric_normal[i]};
  });
  return gpu::uploaded(commands, std::as_bytes(std::span(values)), "the buffer of elements");
}

}  // namespace luxel::device
