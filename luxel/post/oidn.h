// Open Image Denoise, where the build found it (it is not in Debian 12).
#pragma once

#include "luxel/post/denoise.h"

namespace luxel::post {

#ifdef LUXEL_OIDN
inline constexpr bool kHasOidn = true;
#else
inline constexpr bool kHasOidn = false;
#endif

/// Its filter for lightmaps over the square of the atlas, gaps filled from their neighbours first.
/// It knows neither charts nor variances, and promises no same bits. Errors: what the library says.
Status denoise_with_oidn(const TexelGeometry& places, std::span<const NoisyLight> parts,
                         Progress& progress);

}  // namespace luxel::post
