// How the surfaces of a mesh lie in the lightmap: in which pieces, and where they are cut.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::view {

/// Triangles that hang together over edges with the same two places and the same TEXCOORD_1 are a
/// chart. An edge is a seam where another triangle has its two places, but none its TEXCOORD_1.
struct MeshCharts {
  std::vector<uint32_t> chart_of;  ///< of each triangle, from 0
  std::vector<uint8_t> seams;      ///< of each triangle: bit k for the edge across from corner k
  uint32_t charts = 0;
};

/// Empty where the mesh has no TEXCOORD_1.
MeshCharts charts_of(const scene::Mesh& mesh);

}  // namespace luxel::view
