// Pictures of lightmaps.
#pragma once

#include "pipeline/techniques.h"

namespace luxel::pipeline {

/// The bake in settings.from; without one, a small bake made on the spot.
Result<image::Image> draw_lightmap(const Subject& subject, const RenderSettings& settings,
                                   Rendered& out, Progress& progress);

}  // namespace luxel::pipeline
