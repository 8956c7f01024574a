// Look-ups of a lightmap for pictures: edges of light without the saw teeth of bilinear look-ups.
#pragma once

#include <array>

#include "luxel/image/image.h"
#include "luxel/scene/scene.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::display {

/// A look-up at a place between four texels, as weights of the 4 x 4 texels around it, row by row.
struct SmoothWeights {
  float share = 0;                 ///< of the spline in the look-up, 0 .. 1; the rest is bilinear
  std::array<float, 16> weight{};  ///< of the spline; they add up to 1 where share > 0
};

/// The quadratic B-spline over the 3 x 3 texels around the one that holds the place. Saw teeth of a
/// bilinear look-up are its bends at the middles of texels; the spline has none. It reads no texel
/// that a bilinear look-up in the same texel cannot read, so it crosses no wall that those do not.
///
/// Texels that are not `inside` their chart do not count. The spline's share is the bilinear weight
/// of those of the four whose 3 x 3 texels all are, so that it fades out towards the rim of a
/// chart, where seams are stitched for bilinear look-ups. `to`: how far the place is from the
/// middle of the upper left one of the four towards that of the lower right one, 0 .. 1.
SmoothWeights smooth_weights(Vec2 to, const std::array<bool, 16>& inside);

/// A picture with smooth_weights(): pixels whose alpha is 1 are inside. Bilinear without alpha.
Rgb smooth_at(const image::Image& picture, Vec2 uv);

/// lightmap_at() with smooth_weights(). Texels whose alpha is 1 are inside their chart.
Rgb smooth_lightmap_at(const scene::Scene& scene, const image::Image& lightmap,
                       const scene::SurfacePoint& p);

/// transport::irradiance_at() with smooth_weights(). Texels whose middle lies in the point's chart
/// are inside.
Rgb smooth_irradiance_at(const transport::TexelField& field, const scene::SurfacePoint& p);

}  // namespace luxel::display
