// Rows of texels above which there is nothing: most of a large lightmap. One look at the scene
// stands for the rays of all their texels.
#pragma once

#include <cstdint>

#include "luxel/atlas/atlas.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::transport {

/// Texels of one triangle that follow each other in a row of the map.
struct TexelRun {
  uint32_t first = 0, count = 0;
};

/// The run that begins at a texel, of `most` texels at most, of which the map may have fewer, and
/// of no more than are worth one look.
TexelRun run_from(const atlas::TexelMap& map, uint32_t first, uint32_t most);

/// Where above a run nothing may be. A step is the longer of the two sides of a texel on the
/// surface.
struct Clearance {
  float from_m = 0;        ///< the lowest height above the triangle; below 0: behind it
  float to_steps = 0;      ///< the greatest height
  float around_steps = 0;  ///< how far beyond the run and the texels around it
  bool own_chart = false;  ///< whether other triangles of the run's chart count, too
};

/// Nothing lies above a run and the texels around it. The run's own triangle does not count, nor
/// the other side of its sheet. True is certain. False is also said of a run too short to be worth
/// asking about.
bool is_clear(const scene::Scene& scene, const atlas::Atlas& atlas, const atlas::TexelMap& map,
              const trace::RayTracer& tracer, TexelRun run, const Clearance& clearance);

}  // namespace luxel::transport
