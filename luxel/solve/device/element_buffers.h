// Elements and their samples in a device's memory, as shaders/element_rays.glsl reads them.
#pragma once

#include "luxel/gpu/commands.h"
#include "luxel/solve/gather/rays/element_rays.h"
#include "luxel/transport/elements.h"

namespace luxel::device {

/// Elements that lie after each other, whose rays of a cell of directions are traced together.
inline constexpr size_t kTogether = 64;

struct ElementBuffers {
  gpu::Buffer elements;  ///< Element of the shader
  gpu::Buffer samples;   ///< PlainCells
};
/// Some elements, which all have the samples from 0 on. Errors: no memory, the device is lost.
Result<ElementBuffers> element_buffers(gpu::Commands& commands, const transport::Elements& elements,
                                       float diagonal_m, uint32_t samples);

}  // namespace luxel::device
