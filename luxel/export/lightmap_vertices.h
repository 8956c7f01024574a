// Meshes whose triangles know their places in the lightmap: for files and for graphics devices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/pages.h"
#include "luxel/base/vec.h"

namespace luxel::export_ {

/// Where a mesh's triangles lie in the lightmap; both empty where there is none.
struct LightmapCoordinates {
  std::vector<std::array<Vec2, 3>> uv;  ///< per triangle its corners, in [0, 1] of the page
  std::vector<uint32_t> page;           ///< per triangle
  bool attached = true;  ///< false: materials do not show it, and say only where it is
};

/// The places of an instance's triangles. `pages`: atlas::pages_of(atlas).
LightmapCoordinates lightmap_places(const atlas::Atlas& atlas, std::span<const atlas::Page> pages,
                                    uint32_t instance);

/// Vertices of some triangles of a mesh: where each comes from, and its place in the lightmap.
struct LightmapVertices {
  std::vector<uint32_t> source;  ///< vertex of the mesh
  std::vector<Vec2> lightmap;
  std::vector<uint32_t> indices;  ///< three per triangle
};

/// Hands out the vertices of a mesh, or of one part of it after the other; a vertex becomes several
/// where its triangles disagree about the lightmap. The versions of a vertex form a list: few are
/// long.
class VertexSplitter {
 public:
  explicit VertexSplitter(size_t vertex_count) : first_(vertex_count, kNone) {}

  /// The number in `out` of the mesh's vertex `source` at that place.
  uint32_t vertex(LightmapVertices& out, uint32_t source, Vec2 lightmap);
  void start_next_part(const LightmapVertices& done);

 private:
  static constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> first_, next_;
};

/// The values of a mesh at those vertices; none where it has none.
template <class T>
std::vector<T> picked(const std::vector<T>& values, std::span<const uint32_t> source) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(source.size());
  for (const uint32_t i : source) out.push_back(values[i]);
  return out;
}

}  // namespace luxel::export_
