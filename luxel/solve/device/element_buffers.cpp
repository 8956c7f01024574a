#include "luxel/solve/device/element_buffers.h"

#include "luxel/base/parallel.h"

namespace luxel::device {
namespace {

/// Element in element_rays.glsl.
struct DeviceElement {
  Vec3 origin, normal, geometric_normal;
};
static_assert(sizeof(DeviceElement) == 36);

}  // namespace

Result<ElementBuffers> element_buffers(gpu::Commands& commands, const transport::Elements& elements,
                                       float diagonal_m, uint32_t samples) {
  std::vector<DeviceElement> values(elements.size());
  parallel_for(values.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      values[i] = {
          trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m),
          elements.normal[i], elements.geometric_normal[i]};
  });
  gather::PlainCells plain;
  gather::sort_by_plain_cell({0, samples}, plain);
  std::vector<uint32_t> words(plain.first_of.begin(), plain.first_of.end());
  words.insert(words.end(), plain.sample.begin(), plain.sample.end());
  ElementBuffers out;
  LUXEL_TRY(out.elements,
            gpu::uploaded(commands, std::as_bytes(std::span(values)), "the buffer of elements"));
  LUXEL_TRY(out.samples,
            gpu::uploaded(commands, std::as_bytes(std::span(words)), "the buffer of samples"));
  return out;
}

}  // namespace luxel::device
