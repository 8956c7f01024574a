// A scene on a graphics device, with its light as far as it is known.
#pragma once

#include <memory>
#include <optional>

#include "luxel/view/draw/device_scene.h"
#include "luxel/view/live/fade.h"
#include "luxel/view/live/live_bake.h"
#include "luxel/view/open_bake.h"

namespace luxel::view {

struct ShownScene {
  DeviceScene device;
  std::shared_ptr<const ReadScene> read;  ///< null: there is nothing to see yet
  bool has_light = false;                 ///< false: colours can be shown, nothing else
  Fade fade;
  std::optional<LiveLight> waiting;  ///< light that comes when what was there before has faded in
  LiveNumbers numbers;               ///< of the light that came last
  bool has_last = false;             ///< all light has come
};

/// A scene in which nothing can be seen, for a window that opens before the file is read.
Result<ShownScene> nothing_shown(gpu::Commands& commands);

/// A bake that is there. It is used up.
Result<ShownScene> bake_shown(gpu::Commands& commands, OpenedBake bake);

/// Puts what has come on the device. True: `device` is another one than before. `said` gets what is
/// to be told. Nothing may still draw the scene. Errors: no memory on the device.
Result<bool> take_news(LiveNews news, gpu::Commands& commands, ShownScene& shown,
                       std::string& said);

/// Light fades in, and what has waited for that comes. Nothing may still draw the scene. Errors: no
/// memory on the device.
Status pass(double seconds, gpu::Commands& commands, ShownScene& shown);

/// pass(), until all light that has come is shown.
Status settle(gpu::Commands& commands, ShownScene& shown);
/// Whether all light that has come is shown.
bool is_settled(const ShownScene& shown);

}  // namespace luxel::view
