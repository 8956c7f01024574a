// Rays that were traced elsewhere, as on a graphics device, and ended where that does not know what
// they bring: beside walls, near their start, on backs that send light.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/gather/trace/scene_of_rays.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {

struct PathDevice;

struct OpenRay {
  uint32_t element = 0, sample = 0;
  uint32_t doublings = 0;  ///< CellShares of its cell
  trace::Hit hit;          ///< of a surface
};

/// Takes such rays of elements [begin, end) to their ends as trace_more() takes those that it
/// traces: counts what they have met, notes what they bring without the map, and returns their
/// hits, in tiles of kTileElements, of which `begin` is a multiple. `rays`: element after element,
/// of one round. `hits` knows the samples of these elements with those of that round, and what
/// their other rays have met. `device` traces the rays of paths (follow_many.h); null: the
/// processor does. Errors: cancelled; those of the device.
Result<std::vector<HitTile>> end_open_rays(const SceneOfRays& scene, const TraceScene& in,
                                           size_t begin, size_t end, std::span<const OpenRay> rays,
                                           const PathDevice* device, TracedHits& hits,
                                           Progress& progress);

}  // namespace luxel::gather
