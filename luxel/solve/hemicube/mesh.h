// The mesh that the light is computed on: the scene's triangles cut into smaller ones that meet
// edge to edge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"

namespace luxel::hemicube {

inline constexpr uint32_t kNone = scene::kNone;

/// A triangle of the mesh, or one that was cut in two. Corners in the order of the scene's.
struct Node {
  std::array<uint32_t, 3> vertex;  ///< index into Mesh::vertices
  std::array<uint32_t, 3> point;   ///< index into Mesh::points
  std::array<Barycentric, 3> at;   ///< in the scene's triangle
  uint32_t instance = 0, triangle = 0;
  /// 0: a triangle of the mesh. Else it is cut from the middle of its edge `cut_edge` (from corner
  /// k to k + 1) to the corner opposite; the part with corner k is node `child`, the other the
  /// next.
  uint32_t child = 0;
  uint8_t cut_edge = 0;
};

/// Triangles of the scene are cut in two at their longest edge again and again [Rivara84], a
/// triangle and those that share the edge together, so that no vertex lies on another triangle's
/// edge (no T-vertices) and no angle falls under half the smallest one of the scene. Edges that the
/// scene's triangles share by position are shared here, too, also over a crease.
struct Mesh {
  /// A place in space. Triangles of an instance that meet there share it.
  std::vector<Vec3> points;
  /// Where light is computed: a point and a side of the surface. Triangles share a vertex when they
  /// share the point, the normal there (within 3 degrees) and the material; so vertices on creases
  /// are split by face. One of the places that are the vertex:
  std::vector<scene::SurfacePoint> vertices;
  std::vector<uint32_t> point_of;  ///< per vertex
  std::vector<Node> nodes;
  /// Per drawn triangle (scene::first_triangles) its first node, one extra entry at the end: a grid
  /// of grid[instance]^2 nodes, row by row from corner 0 - corner 1 on.
  std::vector<uint32_t> first_root;
  std::vector<uint32_t> first_triangle;  ///< per instance, as scene::first_triangles
  std::vector<uint32_t> grid;            ///< per instance, >= 1
  size_t triangle_count = 0;             ///< nodes that are not cut
};

struct MeshParams {
  /// Triangles become about this small: the leg of a right isosceles triangle [m]. 0: the scene's
  /// own triangles.
  float element_size_m = 0;
  /// More vertices than this are an error.
  size_t max_vertices = 1u << 26;
};

/// Errors (bad_setting): more than max_vertices; (cancelled).
Result<Mesh> make_mesh(const scene::Scene& scene, const MeshParams& params, Progress& progress);

/// A triangle without area, whatever its edges' lengths. It is never cut and has no light.
bool is_flat(const Mesh& mesh, const Node& node);

/// The nodes that are not cut.
std::vector<uint32_t> leaves(const Mesh& mesh);

/// The triangle that holds a point of the scene, and where in it.
struct MeshPoint {
  uint32_t node = 0;
  Barycentric at;
};
/// Descends the tree of cuts from the triangle of the scene that holds the point.
MeshPoint locate(const Mesh& mesh, const scene::SurfacePoint& p);

/// A point of a triangle, in the scene's terms.
scene::SurfacePoint scene_point(const Node& node, Barycentric at);

}  // namespace luxel::hemicube
