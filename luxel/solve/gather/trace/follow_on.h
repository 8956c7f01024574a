// The rays of a tile's elements that are followed on (near_paths.h), all together: those of one
// element would be few.
#pragma once

#include <span>

#include "luxel/solve/gather/reuse/retraced_rays.h"
#include "luxel/solve/gather/trace/sort_rays.h"

namespace luxel::gather {

/// Paths that are followed at a time: enough to fill packets, few enough to stay in a core's cache.
inline constexpr size_t kPathsAtATime = 1024;

/// Takes back those paths of an element, the last that has some, that began on backs, if it lies
/// inside a solid: there it is dark, and paths along its walls, which are long, would bring
/// nothing. `hits` has counted what all its rays have met.
void drop_enclosed_paths(const RayScene& in, const transport::Elements& elements, size_t element,
                         const TracedHits& hits, NearBuffers& near);

/// Where a path has ended; `out` gets the layers of what it saw outside.
FollowedPath ended(const RayScene& in, const NearPath& path, TracedHits& out);

/// Follows buffers.near.paths on and adds where they end to buffers.followed. Returns the number of
/// rays.
uint64_t follow_paths(const RayScene& in, RayBuffers& buffers, TracedHits& out);

/// Follows those paths of a tile on that are left, as follow_paths(); and adds what all of
/// buffers.followed bring to the elements' light and to `tile`, whose ends and other hits are
/// known: the first element is `first`, and ends_of[k] is one past the last of the k-th one's ends.
/// Those of `retraced` that were followed on and not traced again bring what they brought in the
/// earlier bake (null: nothing is known). Returns the number of rays.
uint64_t follow_on(const RayScene& in, size_t first, std::span<const uint32_t> ends_of,
                   const RetracedRays* retraced, RayBuffers& buffers, TracedHits& out,
                   RayTile& tile);

}  // namespace luxel::gather
