// Ways in which baked.glb shows the baked light.
#pragma once

#include <cstdint>

namespace luxel::export_ {

enum class Attach : uint8_t {
  lightmap,  ///< irradiance beside the materials, by the extension MOZ_lightmap
  combined,  ///< unlit materials whose base colour is what surfaces send to the eye
  emissive,  ///< black materials that emit what surfaces send to the eye
};

}  // namespace luxel::export_
