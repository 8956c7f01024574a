// Layout of a mesh's surfaces in the lightmap: its pieces, and the cuts between them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::view {

/// Triangles that hang together over edges with the same two places, in space and in the lightmap,
/// are a chart. An edge is a seam where another triangle has its places in space, but none those in
/// the lightmap.
struct MeshCharts {
  std::vector<uint32_t> chart_of;  ///< of each triangle, from 0
  std::vector<uint8_t> seams;      ///< of each triangle: bit k for the edge across from corner k
  uint32_t charts = 0;
};

/// `light_uv`: of each vertex its place in the lightmap. Without them there are no charts.
MeshCharts charts_of(const scene::Mesh& mesh, std::span<const Vec2> light_uv);

}  // namespace luxel::view
