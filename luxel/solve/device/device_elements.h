// Elements in a device's memory, as shaders/element_rays.glsl reads them.
#pragma once

#include "luxel/gpu/commands.h"
#include "luxel/solve/device/rays_shared.h"
#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/transport/elements.h"

namespace luxel::device {

inline constexpr size_t kTogether = on_device::kRaysTogether;

/// Some elements. Errors: no memory, the device is lost.
Result<gpu::Buffer> upload_elements(gpu::Commands& commands, const transport::Elements& elements);

}  // namespace luxel::device
