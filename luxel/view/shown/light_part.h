// A part of a scene's light in the place of all of it.
#pragma once

#include "luxel/view/shown/shown_scene.h"

namespace luxel::view {

/// The scene shows this part at once, and so does light that comes later. The exposure stays that
/// of all light. Nothing may still draw the scene. Errors: the part is not known, or not so finely,
/// after which the scene shows what it did; those of files; no memory on the device.
Status show_part(const LightShown& light, gpu::Commands& commands, ShownScene& shown);

/// E per page of what is shown: all light that has come last, or the part of it. Errors: as above.
Result<std::vector<image::Image>> pages_shown(const LightShown& light, const ShownScene& shown);

}  // namespace luxel::view
