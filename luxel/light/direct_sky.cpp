// Shadow rays towards the surroundings.
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/shadow_rays.h"

namespace luxel::light {

// Blocked like everything else that is far away; the mean of w V, for nothing is known exactly but
// the density.
void aim_at_bright_texels(const scene::Scene& scene, const Surroundings& around, int samples,
                          const Receiver& r, ShadowRayBatch& batch) {
  if (around.bright_texels.empty()) return;
  const uint32_t source = uint32_t(batch.sources.size());
  batch.sources.push_back({.scale = 1 / float(samples), .planned = uint32_t(samples)});
  for (int k = 0; k < samples; ++k) {
    const BrightTexelSample bright =
        sample_bright_texels(scene, around, sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x13)));
    const float w = folded_cosine(bright.direction, r.normal, r.geometric_normal);
    add_shadow_ray(batch, r, {source, w, bright.radiance_over_pdf * w}, bright.direction, INFINITY);
  }
}

void aim_at_soft_sky(const scene::Scene& scene, const Surroundings& around, int samples,
                     const Receiver& r, ShadowRayBatch& batch) {
  if (samples == 0 || (around.limit == INFINITY && max_component(around.background) <= 0)) return;
  const uint32_t source = uint32_t(batch.sources.size());
  batch.sources.push_back({.scale = kPi / float(samples), .planned = uint32_t(samples)});
  const Frame frame = frame_around(r.normal);
  for (int k = 0; k < samples; ++k) {
    const Vec2 u = sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x14));
    const Vec3 d = mirrored_above(frame.to_world(cosine_hemisphere_sample(u)), r.geometric_normal);
    add_shadow_ray(batch, r, {source, 1, soft_radiance(scene, around, d)}, d, INFINITY);
  }
}

}  // namespace luxel::light
