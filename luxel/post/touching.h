// Edges of different meshes that lie on each other: the joints of kits built from tiles.
#pragma once

#include <vector>

#include "luxel/post/seams.h"

namespace luxel::post {

/// An edge of a drawn triangle over which its own mesh does not go on smoothly: from `corner` to
/// the next one.
struct OpenEdge {
  uint32_t instance = 0, triangle = 0, corner = 0;
};

/// Where two open edges coincide over some length, to within kTouchTolerance of the scene's
/// diagonal and a hundredth of the shorter edge, and one surface goes on where the other ends: the
/// shading normals agree at both ends of that stretch, and the triangles lie on opposite sides of
/// it. Where a third triangle stands on the stretch, a wall on the joint of two tiles, light is cut
/// there, and the joint is none of these. In the order of the edges.
std::vector<Seam> find_touching(const scene::Scene& scene, const atlas::Atlas& atlas,
                                std::span<const OpenEdge> edges, float min_cosine);

inline constexpr float kTouchTolerance = 1e-4f;

}  // namespace luxel::post
