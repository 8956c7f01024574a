// A scene laid out on a lightmap, with all that light at its texels is worked out from.
#pragma once

#include "atlas/atlas.h"
#include "scene/scene.h"
#include "trace/ray_tracer.h"
#include "transport/elements.h"
#include "transport/lights.h"

namespace luxel::transport {

/// Elements are those of the map's texels.
struct TexelScene {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const atlas::TexelMap& map;
  const Elements& elements;
  const Lights& lights;
  const trace::RayTracer& tracer;
};

}  // namespace luxel::transport
