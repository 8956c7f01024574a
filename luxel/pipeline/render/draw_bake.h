// Pictures of lightmaps.
#pragma once

#include "luxel/image/codec.h"
#include "luxel/pipeline/render/techniques.h"

namespace luxel::pipeline {

/// The bake in settings.from; without one, a small bake made on the spot.
Result<image::Image> draw_lightmap(const Subject& subject, const RenderSettings& settings,
                                   Rendered& out, Progress& progress);

/// E of the bake in settings.from at each pixel's surface, not what the surface reflects of it.
Result<image::Image> draw_irradiance_of_bake(const Subject& subject, const RenderSettings& settings,
                                             Rendered&, Progress& progress);
/// Its luminance in false colours, with isolines and a legend.
image::Image8 show_irradiance(const Subject& subject, const image::Image& picture);

/// texels.png of that bake (luxel/pipeline/texels/texel_picture.h) on the surfaces.
Result<image::Image> draw_texels_of_bake(const Subject& subject, const RenderSettings& settings,
                                         Rendered& out, Progress& progress);
/// error.png of that bake on the surfaces.
Result<image::Image> draw_errors_of_bake(const Subject& subject, const RenderSettings& settings,
                                         Rendered&, Progress& progress);

}  // namespace luxel::pipeline
