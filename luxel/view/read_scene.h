// A scene in memory that a viewer shows: what the mouse points at, and where looking begins.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/settings/sky_setting.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// A sky's sun among the lights of a scene, and the sky.
struct SkySun {
  uint32_t light = 0;
  pipeline::SkySetting sky;
};

/// It stays where it is: the tracer looks at the scene.
struct ReadScene {
  scene::Scene scene;                      ///< as it was read, its outside light added
  std::optional<trace::RayTracer> tracer;  ///< of `scene`
  Frame first;                             ///< from where preview.png is taken
  int width = 960, height = 720;           ///< of preview.png
  std::string light_unit;                  ///< of E: "lux" or "W/m^2"
  std::optional<SkySun> sun;               ///< none: there is no such sky, or it is night
};

/// Purpose of a scene's tracer: many rays, or being made again after each edit.
enum class TracedFor : uint8_t { solvers, edits };

/// The scene that a file holds, ready to be looked at, by the view that the settings ask for.
/// Errors: no such view; no memory.
Result<std::shared_ptr<const ReadScene>> read_scene(scene::Scene scene,
                                                    const pipeline::BakeSettings& settings,
                                                    TracedFor traced = TracedFor::solvers);
/// The scene after an edit (edits.h), looked at from where the one before it was.
Result<std::shared_ptr<const ReadScene>> read_scene(scene::Scene scene, const ReadScene& before);

}  // namespace luxel::view
