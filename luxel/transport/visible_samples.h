// Moves samples of texels out of solids.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::transport {

/// Texels, ascending.
struct MovedSamples {
  std::vector<uint32_t> moved;  ///< those whose samples were moved
  /// Those with the back of a surface near their own sample.
  std::vector<uint32_t> near_back_faces;
};

/// A texel across the foot of a wall has one sample, which may lie under the wall while half of the
/// texel lies in the room: it would be dark, or dropped; or just beside the wall, where it is
/// darkest. Texels whose samples see nothing but backs, and their neighbours, are looked at on a
/// grid of 4 x 4 in their own triangle: where the back of a surface is within a texel and a half,
/// and along the borders of larger regions of such samples. Where the grid's corners are like the
/// sample, so is the rest taken to be. Where some places are in the open and some are not, the
/// sample moves to the one in the middle of those that are; elsewhere it stays. The members of a
/// team share the texels out. The stage "samples". Errors: cancelled, another member of the team
/// gives up; the map is of no use then.
Result<MovedSamples> move_samples_out_of_solids(const scene::Scene& scene,
                                                const atlas::Atlas& atlas,
                                                const trace::RayTracer& tracer,
                                                atlas::TexelMap& map, Progress& progress,
                                                Team* team = nullptr);

/// Moves samples where rays meet something else than then within `boxes` alone [m], in a map whose
/// samples all are where they were before they were moved: of texels away from the boxes only
/// those that had backs near them then are looked at. Returns what move_samples_out_of_solids()
/// does.
Result<MovedSamples> move_samples_near_changes(const scene::Scene& scene, const atlas::Atlas& atlas,
                                               const trace::RayTracer& tracer,
                                               std::span<const Box3> boxes,
                                               std::span<const uint32_t> near_back_faces,
                                               atlas::TexelMap& map, Progress& progress);

}  // namespace luxel::transport
