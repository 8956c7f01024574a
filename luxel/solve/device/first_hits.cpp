#include "luxel/solve/device/first_hits.h"

#include "luxel/base/check.h"
#include "luxel/gpu/pieces.h"
#include "luxel/solve/device/first_hits_shared.h"
#include "luxel/solve/device/shaders/first_hits.comp.h"

namespace luxel::device {
namespace {

using on_device::HitsPush;

}  // namespace

Result<FirstHits> prepare_first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                                     const transport::Elements& elements,
                                     const FirstHitsParams& params) {
  const size_t n = elements.size(), tiles = (n + kTogether - 1) / kTogether;
  LUXEL_CHECK(n > 0 && params.samples > 0);
  LUXEL_CHECK(tiles * kTogether * params.samples <= uint64_t(INT32_MAX));
  const gpu::Device& device = tracer.device();
  FirstHits out;
  out.element_count = n, out.params = params;
  LUXEL_TRY(out.elements, upload_elements(commands, elements));
  LUXEL_TRY(out.hits,
            gpu::make_buffer(device, tiles * kTogether * params.samples * sizeof(on_device::Hit),
                             gpu::Access::device, "the buffer of hits"));
  LUXEL_TRY(out.pipeline,
            gpu::make_compute_pipeline(device, first_hits_comp(tracer.kind()),
                                       {sizeof(HitsPush), {}}, {tracer.shader_constant()}));
  return out;
}

Result<double> trace_first_hits(const trace::DeviceRayTracer& tracer, gpu::Commands& commands,
                                FirstHits& hits) {
  const HitsPush push{.world = tracer.world(),
                      .elements = hits.elements.address,
                      .hits = hits.hits.address,
                      .seed = on_device::halves(gather::seed_of_all_rays(hits.params.seed)),
                      .element_count = uint32_t(hits.element_count),
                      .samples = hits.params.samples,
                      .first_group = 0};
  const size_t tiles = (hits.element_count + kTogether - 1) / kTogether;
  return gpu::run_groups(commands, hits.pipeline, push, tiles * gather::kCells, hits.piece);
}

}  // namespace luxel::device
