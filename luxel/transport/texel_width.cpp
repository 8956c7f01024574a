#include "luxel/transport/texel_width.h"

#include <cmath>

namespace luxel::transport {

float texel_width_m(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t instance,
                    uint32_t triangle) {
  return texel_width_m(atlas, atlas.triangle_number(instance, triangle),
                       scene::world_triangle(scene, instance, triangle));
}

float texel_width_m(const atlas::Atlas& atlas, uint32_t number, const scene::Triangle3& world) {
  const auto& c = atlas.corners[number];
  const double texels = 0.5 * std::abs(double(cross(c[1] - c[0], c[2] - c[0])));
  const double area_m2 = double(scene::area_m2(world));
  return texels > 0 ? float(std::sqrt(area_m2 / texels)) : 0;
}

}  // namespace luxel::transport
