// A scene on a graphics device that follows its lamps.
#pragma once

#include "luxel/view/draw/direct_light.h"
#include "luxel/view/relight/open_lxr.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view {

/// The scene of an .lxr file, and what draws its lamps.
struct RelitScene {
  ShownScene shown;
  DirectLight direct;
};

/// With the light of the lamps as they were baked. Errors: no memory on the device.
Result<RelitScene> lxr_shown(gpu::Commands& commands, OpenedLxr& opened);

/// What the light of a picture took [ms].
struct LightTimes {
  double direct = 0, bounces = 0, places = 0;  ///< of matrix::Relighter
  double map = 0;                              ///< the lightmap, and its way to the device
  double shadows = 0;                          ///< maps of shadows
  double relit() const { return direct + bounces + places; }
};

/// The next picture is lit by these lamps: light of all bounces, then the lamps themselves, then
/// their shadows. Nothing may still draw the scene. Errors: no memory, the device is lost.
/// `eye`: whose picture it is; null: anyone's.
Result<LightTimes> follow_lamps(gpu::Commands& commands, const Lamps& lamps,
                                const trace::CameraRays* eye, OpenedLxr& opened,
                                DirectLight& direct, DeviceScene& scene);

/// The next picture is this eye's, the lamps as before: shadows of suns are sharp near to it.
/// Returns what that took [ms]. Nothing may still draw the scene. Errors: as follow_lamps().
Result<double> follow_eye(gpu::Commands& commands, const Lamps& lamps, const trace::CameraRays& eye,
                          DirectLight& direct, DeviceScene& scene);

}  // namespace luxel::view
