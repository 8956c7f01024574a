// Parameters shared by shaders whose triangles stand among the surfaces of a scene.
#pragma once

#include "luxel/gpu/pipeline.h"

namespace luxel::view {

/// Into the picture of exposed radiance, of this format and so many samples, with the depth that
/// surfaces have there (Painter::exposed). Shaders and what they bind are to be filled in.
inline gpu::DrawParams among_surfaces(VkFormat color, VkSampleCountFlagBits samples) {
  gpu::DrawParams out;
  out.colors = {color};
  out.depth = VK_FORMAT_D32_SFLOAT;
  out.samples = samples;
  return out;
}

}  // namespace luxel::view
