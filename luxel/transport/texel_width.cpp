#include "luxel/transport/texel_width.h"

#include <cmath>

namespace luxel::transport {

float texel_width_m(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t instance,
                    uint32_t triangle) {
  const auto& c = atlas.corners[atlas.triangle_number(instance, triangle)];
  const double texels = 0.5 * std::abs(double(cross(c[1] - c[0], c[2] - c[0])));
  const double area_m2 = double(scene::area_m2(scene::world_triangle(scene, instance, triangle)));
  return texels > 0 ? float(std::sqrt(area_m2 / texels)) : 0;
}

}  // namespace luxel::transport
