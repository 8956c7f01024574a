// The surfaces that paths meet: triangles with their front normals.
#pragma once

#include <cstdint>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::reference {

/// Where light is gathered: beside one side of a surface, off it by what rounding may do.
/// Directions are those of that side.
struct Receiver {
  Vec3 position, normal, geometric_normal;
};

/// Facts of every drawn triangle (numbered as scene::first_triangles does), worked out once.
struct Surfaces {
  std::vector<uint32_t> first_triangle;
  std::vector<Vec3> front;      ///< unit normal of the front side, in the world
  std::vector<float> size_m;    ///< scene::size_for_rounding()
  std::vector<uint8_t> curved;  ///< 1 where vertex normals differ from `front`

  uint32_t number(uint32_t instance, uint32_t triangle) const {
    return first_triangle[instance] + triangle;
  }
};
Surfaces surfaces_of(const scene::Scene& scene);

/// The side of the surface that a ray met, and where light is gathered on it. On the front that is
/// the point, lifted and with the shading normal, at which a texel would lie; on the back of a
/// double-sided surface it is the flat triangle with the opposite normals.
Receiver receiver_at(const scene::Scene& scene, const Surfaces& surfaces, const trace::Hit& hit);

}  // namespace luxel::reference
