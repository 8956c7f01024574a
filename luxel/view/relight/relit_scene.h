// A scene on a graphics device that follows its lamps.
#pragma once

#include <optional>

#include "luxel/view/draw/direct_light.h"
#include "luxel/view/draw/light_at_points.h"
#include "luxel/view/relight/open_lxr.h"
#include "luxel/view/relight/relit_on_device.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view {

/// State for drawing the lamps of an .lxr file.
struct LampDrawing {
  DirectLight direct;
  /// The light of all bounces, on the device; nothing: the processor's.
  std::optional<RelitOnDevice> relit;
  /// The light of its patches, by the maps of shadows; nothing: by shadow rays.
  std::optional<LightAtPoints> patches;
};
/// The scene of an .lxr file, and what draws its lamps.
struct RelitScene {
  ShownScene shown;
  LampDrawing lamps;
};

/// Where light of all bounces is worked out, and what patches get straight from lamps.
enum class PatchLight : uint8_t {
  by_rays,  ///< all by the processor
  by_maps,  ///< patches by the maps of shadows that the device has drawn, the rest by the processor
  on_device  ///< all on the device, patches by shadow rays
};
/// On a graphics card all of it; on a processor that plays one, by its own code.
PatchLight patch_light_of(const gpu::Device& device);

/// With the light of the lamps as they were baked. A file that the device does not know, or has no
/// memory for, is relit by maps instead. Errors: no memory on the device.
Result<RelitScene> lxr_shown(gpu::Commands& commands, PatchLight patches, OpenedLxr& opened);

/// Times that the light of a picture took [ms].
struct LightTimes {
  double direct = 0, bounces = 0, places = 0;  ///< of matrix::Relighter
  double map = 0;                              ///< the lightmap, and its way to the device
  double shadows = 0;  ///< maps of shadows, and the patches' light from them
  double relit() const { return direct + bounces + places; }
};

/// The next picture is lit by these lamps: themselves, their shadows, then light of all bounces.
/// Nothing may still draw the scene. Errors: no memory, the device is lost. `eye`: whose picture it
/// is; null: anyone's.
Result<LightTimes> follow_lamps(gpu::Commands& commands, const Lamps& lamps,
                                const trace::CameraRays* eye, OpenedLxr& opened,
                                LampDrawing& drawing, DeviceScene& scene);

/// The next picture is this eye's, the lamps as before: shadows of suns are sharp near to it.
/// Returns what that took [ms]. Nothing may still draw the scene. Errors: as follow_lamps().
Result<double> follow_eye(gpu::Commands& commands, const Lamps& lamps, const trace::CameraRays& eye,
                          LampDrawing& drawing, DeviceScene& scene);

}  // namespace luxel::view
