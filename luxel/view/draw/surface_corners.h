// Triangles corner by corner, as the shaders of techniques read them.
#pragma once

#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/solve/hemicube/receivers.h"

namespace luxel::view {

/// A corner of a drawn triangle, in the world; shaders/technique.glsl has the same in scalar
/// layout.
struct SurfaceCorner {
  Vec3 position, normal;  ///< [m]; the shading normal, on the side of the front
  Vec2 uv0, uv1;
  Rgb color{1, 1, 1};    ///< of the vertex
  float clear = 0;       ///< 1 - alpha of the vertex
  uint32_t element = 0;  ///< whose light it has
  uint32_t item = 0;     ///< the colour that stands for its triangle: 0xbbggrr, display values
};
static_assert(sizeof(SurfaceCorner) == 64);

/// Triangles of one material, which are drawn together.
struct CornerRange {
  uint32_t material = 0;
  uint32_t first = 0, count = 0;  ///< corners
};

/// All triangles, three corners each, counter-clockwise from the front.
struct SurfaceCorners {
  std::vector<SurfaceCorner> corners;
  std::vector<CornerRange> ranges;
};

/// The scene's own triangles. Their elements are 0.
SurfaceCorners corners_of(const scene::Scene& scene);
/// The triangles of a mesh of the scene, with the elements of its corners or its triangles.
SurfaceCorners corners_of(const scene::Scene& scene, const hemicube::Mesh& mesh,
                          const hemicube::Receivers& receivers);

/// The colour that stands for a triangle of the mesh, by its number in Receivers::leaves: 0xbbggrr,
/// display values, none of them dark.
uint32_t item_color(uint32_t leaf);

}  // namespace luxel::view
