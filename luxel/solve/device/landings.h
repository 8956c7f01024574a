// Where rays that meet a triangle land in the lightmap, for shaders.
#pragma once

#include <array>
#include <vector>

#include "luxel/solve/gather/trace/sort_rays.h"

namespace luxel::device {

/// One side of a drawn triangle: Landing of shaders/landings.glsl.
struct Landing {
  std::array<Vec2, 3> corners;  ///< in the lightmap [texels]: atlas::Atlas::corners
  float near_m = 0;             ///< rays that end nearer are followed on (gather::near_paths.h)
  uint32_t kind = 0;            ///< of the bits below

  static constexpr uint32_t kDark = 1;        ///< the back of a one-sided surface
  static constexpr uint32_t kFollowed = 2;    ///< rays are followed on, however far it is
  static constexpr uint32_t kFromBehind = 4;  ///< the back of a surface that sends light there
};
static_assert(sizeof(Landing) == 32);

/// Two of each drawn triangle, in the order of atlas::Atlas::triangle_number: what rays meet that
/// come from its front, and from behind.
std::vector<Landing> landings_of(const gather::RayScene& in);

}  // namespace luxel::device
