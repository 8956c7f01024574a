// Elements: the points at which light is computed. Texels today; vertices, triangles and patches
// later.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/mapped_memory.h"
#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"

namespace luxel::transport {

/// Structure of arrays, all of the same length.
struct Elements {
  /// Where rays start: off the surface (the smooth one) on its front by what rounding may do
  /// (luxel/scene/off_surface.h), world [m].
  MappedVector<Vec3> position;
  MappedVector<Vec3> normal;            ///< unit shading normal of the front side
  MappedVector<Vec3> geometric_normal;  ///< unit; no light comes from below the plane it spans
  MappedVector<Rgb> reflectance;        ///< rho in [0, 0.99]
  /// tau: what of the irradiance on the other side leaves this one. Empty where nothing scatters
  /// light through.
  MappedVector<Rgb> transmittance;

  /// The number of elements, also after drop_places().
  size_t size() const { return std::max(position.size(), reflectance.size()); }
};

/// Memory that drop_places() frees.
inline constexpr uint64_t kPlaceBytesPerElement =
    bytes_per_entry(&Elements::position, &Elements::normal, &Elements::geometric_normal);

/// Frees positions and normals, which take three quarters of the memory, of elements that only
/// exchange light from now on.
void drop_places(Elements& elements);

/// Some elements, in the order of `chosen`.
Elements subset(const Elements& elements, std::span<const uint32_t> chosen);

/// A point of one side, the front unless told otherwise, moved to the smooth surface that vertex
/// normals bend over its triangle.
struct SmoothPoint {
  Vec3 position;                  ///< on that surface, world [m]
  Vec3 start;                     ///< where rays start, Elements::position
  Vec3 normal, geometric_normal;  ///< as in Elements
};
/// The smooth point of a surface point; on the triangle where the mesh has no normals. With a side
/// of -1 it is that of the back: directions point there, and rays start there.
SmoothPoint smooth_point(const scene::Scene& scene, const scene::SurfacePoint& p, float side = 1);

/// One element per texel of the map, in its order. Where vertex normals say that the surface bulges
/// over its triangle, the element lies on the bulge and its horizon is that of the shading normal:
/// else facets would show at the border of light and shadow [Hanika21]. Reflectance is
/// the mean over the part of the texel that its triangle covers, so that a fine texture is neither
/// missed nor aliased. They lie where the texels of the map do.
Elements elements_from_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const atlas::TexelMap& map);
/// elements_from_texels() by the members of a team, which share their colours out: pictures are
/// looked up many times for each texel. All get all of them. The stage "surfaces". Errors:
/// cancelled, another member gives up.
Result<Elements> elements_together(const scene::Scene& scene, const atlas::Atlas& atlas,
                                   const atlas::TexelMap& map, Team* team, Progress& progress);

}  // namespace luxel::transport
