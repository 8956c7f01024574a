// Elements: the points at which light is computed. Texels today; vertices, triangles and patches
// later.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "atlas/atlas.h"
#include "base/vec.h"
#include "scene/scene.h"

namespace luxel::transport {

/// Structure of arrays, all of the same length.
struct Elements {
  std::vector<Vec3> position;          ///< on the surface, world [m]
  std::vector<Vec3> normal;            ///< unit shading normal of the front side
  std::vector<Vec3> geometric_normal;  ///< unit normal of the triangle's front side
  std::vector<Rgb> reflectance;        ///< rho in [0, 0.99]

  size_t size() const { return position.size(); }
};

/// One element per texel of the map, in its order. Reflectance is the mean over the part of the
/// texel that its triangle covers, so that a fine texture is neither missed nor aliased.
Elements elements_from_texels(const scene::Scene& scene, const atlas::Atlas& atlas,
                              const atlas::TexelMap& map);

}  // namespace luxel::transport
