// Probes of a bake, drawn as balls in their own light.
#pragma once

#include <array>

#include "luxel/gpu/pipeline.h"
#include "luxel/view/draw/overlay.h"
#include "luxel/view/frame.h"
#include "luxel/view/model/probe_balls.h"

namespace luxel::view {

/// Draws balls, into pictures as surfaces are drawn into.
Result<gpu::Pipeline> make_probe_shader(const gpu::Device& device, VkFormat color,
                                        VkSampleCountFlagBits samples);

struct DeviceProbes {
  gpu::Buffer probes;
  uint32_t count = 0;
  float radius_m = 0;
};

/// Errors: no memory on the device.
Result<DeviceProbes> put_probes(const gpu::Device& device, const ProbeBalls& balls);

/// White balls in the light of their probes, or in false colours where `overlay` shows those of
/// irradiance, which set_shown() has chosen; null: it shows none.
void draw_probes(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                 const DeviceProbes& probes, const Overlay* overlay, const Frame& frame,
                 const std::array<float, 16>& clip_from_world);

}  // namespace luxel::view
