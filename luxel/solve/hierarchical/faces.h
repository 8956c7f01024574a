// The scene as flat convex polygons: what is subdivided, what shines, what blocks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/viewfactor/point_visibility.h"

namespace luxel::hierarchical {

using viewfactor::Polygon;
using viewfactor::PolygonView;

inline constexpr uint32_t kNone = scene::kNone;

/// Triangles of one instance and material in one plane, joined where the union is convex
/// (luxel/viewfactor/merge_polygons.h). A triangle whose vertex normals bend is a face of its own.
struct Face {
  Polygon corners;  ///< counter-clockwise from the front [m]
  Plane plane;
  float size_m = 0;  ///< scene::size_for_rounding()
  uint32_t instance = 0, material = 0;
  uint32_t triangle = 0;   ///< of the mesh: one of them
  bool two_sided = false;  ///< its back shows the light of its front
  bool curved = false;     ///< light depends on vertex normals
  bool has_holes = false;  ///< a mask: what it hides only rays can tell
};

struct Faces {
  std::vector<Face> faces;
  std::vector<uint32_t> first_triangle;    ///< per instance, as scene::first_triangles
  std::vector<uint32_t> face_of_triangle;  ///< per drawn triangle; kNone for one without area
  double slack_m = 0;                      ///< corners nearer to a plane lie in it

  size_t size() const { return faces.size(); }
};

/// At least one of the faces `some` has holes.
bool has_holes(const Faces& faces, std::span<const uint32_t> some);

/// Errors: cancelled.
Result<Faces> make_faces(const scene::Scene& scene, Progress& progress);

}  // namespace luxel::hierarchical
