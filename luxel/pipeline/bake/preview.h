// preview.png: the first picture that anybody sees of a bake.
#pragma once

#include <utility>

#include "luxel/pipeline/bake/bake_scene.h"

namespace luxel::pipeline {

/// The shape of a picture whose camera leaves it open.
inline constexpr float kPreviewAspect = 4.0f / 3;
/// Width and height of preview.png [pixels].
std::pair<int, int> preview_size(const scene::Camera& camera);

/// bake.preview, from where settings.view says, or else the scene's first camera, or a fitted one.
/// Where it shows no front of a surface it shows the backs, hatched. A warning says why a picture
/// is plain. Errors: those of choose_camera(); cancelled.
Status draw_preview(const BakeSettings& settings, const trace::RayTracer& tracer, Bake& bake,
                    Progress& progress);

}  // namespace luxel::pipeline
