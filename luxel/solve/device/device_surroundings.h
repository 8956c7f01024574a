// The soft light around a scene, in a device's memory.
#pragma once

#include "luxel/gpu/commands.h"
#include "luxel/light/surroundings.h"

namespace luxel::device {

/// Buffers that shaders/surroundings.glsl reads.
struct DeviceSurroundings {
  gpu::Buffer values;
  gpu::Buffer pixels;  ///< of the map
};

/// Errors: no memory, the device is lost.
Result<DeviceSurroundings> upload_surroundings(gpu::Commands& commands,
                                               const scene::Environment& map,
                                               const light::Surroundings& around);

}  // namespace luxel::device
