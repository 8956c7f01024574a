// Everything that paths look at, in a device's memory.
#pragma once

#include "luxel/gpu/commands.h"
#include "luxel/reference/paths.h"
#include "luxel/trace/vulkan/device_ray_tracer.h"

namespace luxel::reference {

/// Buffers that shaders/world_of_paths.glsl reads; `setup` has the addresses of the others.
struct PathBuffersOnDevice {
  gpu::Buffer triangles, materials, texels, linear_of_byte;
  gpu::Buffer emitters, chance_below, lights;
  gpu::Buffer row_below, column_below, pixels;
  gpu::Buffer setup;
};

/// Errors: no memory, the device is lost.
Result<PathBuffersOnDevice> upload_world(gpu::Commands& commands,
                                         const trace::DeviceRayTracer& tracer,
                                         const TracedScene& world);

}  // namespace luxel::reference
