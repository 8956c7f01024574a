// Lamps of a scene that is edited: where its light lacks theirs, they are drawn.
#pragma once

#include <optional>
#include <vector>

#include "luxel/view/draw/direct_light.h"
#include "luxel/view/edit/edits.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view {

/// State for drawing the lamps of one scene on a device.
struct DrawnLamps {
  std::optional<DirectLight> direct;     ///< once it is needed
  std::vector<Mat34> world_from_object;  ///< of each instance, where maps of shadows have it
};

/// The lamps that are on.
std::vector<scene::PunctualLight> shining(const SceneNow& now);

/// The next picture has as much light of these lamps as lamp_share() says, shadows of suns sharp
/// near to the eye. Nothing may still draw the scene. Errors: no memory, the device is lost.
Status draw_lamps(gpu::Commands& commands, const SceneNow& now, const trace::CameraRays& eye,
                  ShownScene& shown, DrawnLamps& drawn);

}  // namespace luxel::view
