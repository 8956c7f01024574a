// A scene on a graphics device that follows its lamps.
#pragma once

#include "luxel/view/draw/direct_light.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/relight/open_lxr.h"

namespace luxel::view {

/// What of an .lxr file lies on the device.
struct RelitScene {
  DeviceScene scene;
  DirectLight direct;
};

/// With the light of the lamps as they were opened. Errors: no memory on the device.
Result<RelitScene> put_on_device(gpu::Commands& commands, OpenedLxr& opened);

/// The next picture is lit by these lamps: light of all bounces, then the lamps themselves, then
/// their shadows. Nothing may still draw the scene. Errors: no memory, the device is lost.
Status follow_lamps(gpu::Commands& commands, const Lamps& lamps, OpenedLxr& opened,
                    RelitScene& relit);

}  // namespace luxel::view
