#include "luxel/solve/device/first_hits.h"

#include "luxel/base/check.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/shaders/first_hits_binary.comp.h"
#include "luxel/solve/device/shaders/first_hits_wide.comp.h"

namespace luxel::device {
namespace {

constexpr size_t kTogether = 64;  // elements of a work group, as the shader has it

/// Element in element_rays.glsl.
struct DeviceElement {
  Vec3 origin, normal, geometric_normal;
};
static_assert(sizeof(DeviceElement) == 36);

struct HitsPush {
  trace::DeviceWorld world;
  VkDeviceAddress elements, plain, hits;
  uint32_t seed_low, seed_high;
  uint32_t element_count, samples;
  uint32_t first_group = 0;
  uint32_t unused = 0;
};
static_assert(sizeof(HitsPush) <= 128);

Result<gpu::Buffer> buffer_of_elements(gpu::Commands& commands, const transport::Elements& elements,
                                       float diagonal_m) {
  std::vector<DeviceElement> out(elements.size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = {trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m),
              elements.normal[i], elements.geometric_normal[i]};
  return gpu::uploaded(commands, std::as_bytes(std::span(out)), "the buffer of elements");
}

/// PlainCells in element_rays.glsl.
Result<gpu::Buffer> buffer_of_samples(gpu::Commands& commands, uint32_t samples) {
  gather::PlainCells plain;
  gather::sort_by_plain_cell({0, samples}, plain);
  std::vector<uint32_t> words(plain.first_of.begin(), plain.first_of.end());
  words.insert(words.end(), plain.sample.begin(), plain.sample.end());
  return gpu::uploaded(commands, std::as_bytes(std::span(words)), "the buffer of samples");
}

}  // namespace

Result<FirstHits> prepare_first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                                     const transport::Elements& elements, float diagonal_m,
                                     const FirstHitsParams& params) {
  const size_t n = elements.size(), tiles = (n + kTogether - 1) / kTogether;
  LUXEL_CHECK(n > 0 && params.samples > 0);
  LUXEL_CHECK(tiles * kTogether * params.samples <= uint64_t(INT32_MAX));
  const gpu::Device& device = tracer.device();
  FirstHits out;
  out.element_count = n, out.params = params;
  LUXEL_TRY(out.elements, buffer_of_elements(commands, elements, diagonal_m));
  LUXEL_TRY(out.samples, buffer_of_samples(commands, params.samples));
  LUXEL_TRY(out.hits,
            gpu::make_buffer(device, tiles * kTogether * params.samples * sizeof(trace::DeviceHit),
                             gpu::Access::device, "the buffer of hits"));
  const bool wide = tracer.kind() == trace::HierarchyKind::wide;
  LUXEL_TRY(
      out.pipeline,
      gpu::make_compute_pipeline(
          device, wide ? gpu::Spirv(first_hits_wide_comp) : gpu::Spirv(first_hits_binary_comp),
          {sizeof(HitsPush), {}}, {uint32_t(tracer.lets_light_through())}));
  return out;
}

Result<double> trace_first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                                FirstHits& hits) {
  const gpu::Device& device = tracer.device();
  const uint64_t seed = gather::seed_of_all_rays(hits.params.seed);
  HitsPush push{.world = tracer.world(),
                .elements = hits.elements.address,
                .plain = hits.samples.address,
                .hits = hits.hits.address,
                .seed_low = uint32_t(seed),
                .seed_high = uint32_t(seed >> 32),
                .element_count = uint32_t(hits.element_count),
                .samples = hits.params.samples};
  const size_t tiles = (hits.element_count + kTogether - 1) / kTogether;
  return gpu::run_in_pieces(commands, tiles * gather::kCells,
                            device.limits.maxComputeWorkGroupCount[0], hits.piece,
                            [&](VkCommandBuffer c, size_t first, size_t count) {
                              push.first_group = uint32_t(first);
                              gpu::bind(device, c, hits.pipeline, push);
                              device.vk.vkCmdDispatch(c, uint32_t(count), 1, 1);
                            });
}

}  // namespace luxel::device
