// A scene laid out on a lightmap, with all that light at its texels is worked out from.
#pragma once

#include "luxel/atlas/atlas.h"
#include "luxel/light/lights.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::light {

class LightDevice;

/// Elements are those of the map's texels.
struct TexelScene {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const atlas::TexelMap& map;
  const transport::Elements& elements;
  const Lights& lights;
  const trace::RayTracer& tracer;
  /// Works direct light out where light is not told apart; parts are kept, but not looked for.
  /// Null: the processor.
  LightDevice* light_device = nullptr;
};

}  // namespace luxel::light
