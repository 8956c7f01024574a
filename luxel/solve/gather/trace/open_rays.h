// Rays that were traced elsewhere, as on a graphics device, and ended where that does not know what
// they bring: beside walls, near their start, on backs that send light.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {

struct OpenRay {
  uint32_t element = 0, sample = 0;
  trace::Hit hit;  ///< of a surface
};

/// Takes such rays to their ends as trace_more() takes those that it traces: counts what they have
/// met, notes what they bring without the map, and returns their hits, in tiles of kTileElements.
/// `rays`: element after element, of each element's first round. `hits` knows its samples, all of
/// which are counted, and what its other rays have met. In params neither parts, keep nor earlier.
/// Errors: cancelled.
Result<std::vector<HitTile>> end_open_rays(const TraceScene& in, std::span<const OpenRay> rays,
                                           const TraceParams& params, TracedHits& hits,
                                           Progress& progress);

}  // namespace luxel::gather
