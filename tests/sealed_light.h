// Light in the sealed room of a sealed_house(), where there is none.
#pragma once

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/transport/irradiance_field.h"
#include "tests/sealed_house.h"

namespace luxel::testing_support {

struct SealedLight {
  size_t texels = 0, lit_texels = 0;
  size_t lookups = 0, lit_lookups = 0;  ///< lit: more than a thousandth of the mean of all texels
  double brightest = 0;                 ///< texel inside, over that mean
};

/// True where a surface faces into the sealed room.
inline bool is_inside(const SealedHouse& house, const scene::Scene& scene,
                      const scene::SurfacePoint& p) {
  const Vec3 front = scene::front_normal(scene, p.instance, p.triangle);
  return is_in_sealed_room(house, scene::world_position(scene, p) + front * 1e-3f);
}

inline SealedLight sealed_light(const SealedHouse& house, const pipeline::Bake& bake) {
  SealedLight out;
  double sum = 0;
  for (size_t i = 0; i < bake.map.texels.size(); ++i) {
    const float e = luminance(bake.light.irradiance[i]);
    sum += double(e);
    if (!is_inside(house, bake.scene, bake.map.texels[i].sample)) continue;
    ++out.texels, out.lit_texels += e > 0;
    out.brightest = std::max(out.brightest, double(e));
  }
  const double mean = sum / double(bake.map.texels.size());
  out.brightest /= mean;
  const transport::TexelField field{&bake.atlas, &bake.map, bake.light.irradiance};
  for (uint32_t i = 0; i < bake.scene.instances.size(); ++i)
    for (uint32_t t = 0; t < bake.scene.meshes[bake.scene.instances[i].mesh].triangles.size(); ++t)
      for (uint32_t k = 0; k < 500; ++k) {
        Vec2 u = sobol_owen_2d(k, t);
        if (u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
        const scene::SurfacePoint p{i, t, {u.x, u.y}};
        if (!is_inside(house, bake.scene, p)) continue;
        ++out.lookups;
        out.lit_lookups += double(luminance(transport::irradiance_at(field, p))) > 1e-3 * mean;
      }
  return out;
}

/// Few rays: light is there or it is not.
inline pipeline::BakeSettings sealed_settings(int resolution) {
  pipeline::BakeSettings settings;
  settings.resolution = resolution, settings.samples = 32, settings.direct_samples = 16;
  return settings;
}

}  // namespace luxel::testing_support
