#include "luxel/view/draw/probe_drawing.h"

#include <span>
#include <vector>

#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/probe_shared.h"
#include "luxel/view/shaders/probe.frag.h"
#include "luxel/view/shaders/probe.vert.h"

namespace luxel::view {
namespace {

/// Round enough for a ball of a tenth of the picture.
constexpr uint32_t kSlices = 24, kStacks = 12;

using on_device::ProbePush;

}  // namespace

Result<gpu::Pipeline> make_probe_shader(const gpu::Device& device, VkFormat color,
                                        VkSampleCountFlagBits samples) {
  gpu::DrawParams params = among_surfaces(color, samples);
  params.vertex = probe_vert, params.fragment = probe_frag;
  params.interface.push_bytes = sizeof(ProbePush);
  return gpu::make_draw_pipeline(device, params);
}

Result<DeviceProbes> put_probes(const gpu::Device& device, const ProbeBalls& balls) {
  DeviceProbes out;
  std::vector<on_device::Probe> probes;
  for (const light::Probe& probe : balls.probes)
    probes.push_back({probe.position, probe.irradiance});
  out.count = uint32_t(probes.size()), out.radius_m = radius_of(balls);
  if (probes.empty()) probes.resize(1);  // no buffer is empty
  LUXEL_TRY(out.probes,
            gpu::buffer_with(device, std::as_bytes(std::span(probes)), "the probes of the bake"));
  return out;
}

void draw_probes(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                 const DeviceProbes& probes, const Overlay* overlay, const Frame& frame,
                 const std::array<float, 16>& clip_from_world) {
  const ProbePush push{.clip_from_world = clip_from_world,
                       .probes = probes.probes.address,
                       .look = overlay ? overlay->shown.address : 0,
                       .shows_false_colors = overlay != nullptr && frame.show == Show::irradiance,
                       .exposure = frame.exposure,
                       .radius = probes.radius_m,
                       .slices = kSlices,
                       .stacks = kStacks};
  gpu::bind(device, commands, shader, push);
  device.vk.vkCmdDraw(commands, 6 * kSlices * kStacks, probes.count, 0, 0);
}

}  // namespace luxel::view
