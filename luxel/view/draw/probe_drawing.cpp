#include "luxel/view/draw/probe_drawing.h"

#include <span>
#include <vector>

#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/shaders/probe.frag.h"
#include "luxel/view/shaders/probe.vert.h"

namespace luxel::view {
namespace {

/// Round enough for a ball of a tenth of the picture.
constexpr uint32_t kSlices = 24, kStacks = 12;

// The structs of shaders/probe.glsl, in scalar layout.
struct DeviceProbe {
  Vec3 position;
  std::array<Rgb, kSh2> irradiance;
};
static_assert(sizeof(DeviceProbe) == 120);

struct ProbePush {
  std::array<float, 16> clip_from_world;  ///< column by column
  VkDeviceAddress probes, look;
  uint32_t shows_false_colors = 0;
  float exposure = 1, radius = 0;
  uint32_t slices = kSlices, stacks = kStacks, padding = 0;
};
static_assert(sizeof(ProbePush) == 104);

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
  std::vector<DeviceProbe> probes;
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
  ProbePush push{clip_from_world, probes.probes.address, overlay ? overlay->shown.address : 0};
  push.shows_false_colors = overlay != nullptr && frame.show == Show::irradiance;
  push.exposure = frame.exposure, push.radius = probes.radius_m;
  gpu::bind(device, commands, shader, push);
  device.vk.vkCmdDraw(commands, 6 * kSlices * kStacks, probes.count, 0, 0);
}

}  // namespace luxel::view
