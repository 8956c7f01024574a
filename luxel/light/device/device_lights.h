// The lights of a scene in a device's memory.
#pragma once

#include "luxel/gpu/commands.h"
#include "luxel/light/lights.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::light {

/// Buffers that shaders/lights.glsl reads; `setup` has the addresses of the others.
struct DeviceLights {
  gpu::Buffer triangles, nodes;
  gpu::Buffer textures, texels, linear_of_byte;  ///< of textured triangles
  gpu::Buffer punctual, punctual_order, punctual_nodes;
  gpu::Buffer profiles, profile_values;
  gpu::Buffer bright_texels, guide, below, row_cosine, pixels;
  gpu::Buffer setup;
};

/// True: a device can compute the light of all of the scene's lights. Textured lights that let
/// light through are beyond it.
bool device_knows(const scene::Scene& scene, const Lights& lights);

/// Sends the lights of `scene` to the device, of which it knows all. Errors: no memory, the device
/// is lost.
Result<DeviceLights> upload_lights(gpu::Commands& commands, const trace::DeviceRayTracer& tracer,
                                   const scene::Scene& scene, const Lights& lights);

}  // namespace luxel::light
