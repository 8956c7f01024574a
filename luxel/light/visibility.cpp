#include "luxel/light/visibility.h"

#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/points_of_texels.h"

namespace luxel::light {
namespace {

/// Numbers that set the seeds of both apart from others.
constexpr uint64_t kMaskSeed = 0x3a5c, kOcclusionSeed = 0xa0cc;

/// The only light, which shines everywhere.
Lights lone_light(const scene::PunctualLight& light) {
  Lights out;
  out.punctual.push_back(light);
  scene::PunctualLight& lone = out.punctual.back();
  lone.intensity = {1, 1, 1}, lone.range_m = 0, lone.profile = scene::kNone;
  if (lone.kind == scene::PunctualLight::Kind::spot) lone.kind = scene::PunctualLight::Kind::point;
  return out;
}

/// The mean over receivers of the share that each has seen of the batch's one light.
float mean_share(const ShadowRayBatch& batch, size_t receivers) {
  float sum = 0;
  for (const Source& source : batch.sources)
    if (source.sum_weight > 0) sum += luminance(source.sum) / source.sum_weight;
  return std::clamp(sum / float(receivers), 0.0f, 1.0f);
}

}  // namespace

Result<std::vector<float>> visible_share(const TexelScene& in, std::span<const uint8_t> hidden,
                                         const scene::PunctualLight& light,
                                         const VisibilityParams& params, Progress& progress) {
  const Lights lone = lone_light(light);
  const DirectScene lit{in.scene, lone, in.tracer};
  std::vector<float> share(in.map.texels.size());
  LUXEL_TRY_STATUS(visit_points(
      in, hidden, params.points, hash64(params.seed, kMaskSeed), "shadow mask",
      [&](size_t texel, std::span<const Receiver> points) {
        thread_local ShadowRayBatch batch;
        thread_local std::vector<LightAt> light_at;
        light_at.resize(points.size());
        direct_light_at(lit, {.samples = params.samples}, points, batch, light_at);
        share[texel] = mean_share(batch, points.size());
      },
      progress));
  return share;
}

Result<std::vector<float>> open_share(const TexelScene& in, std::span<const uint8_t> hidden,
                                      const OcclusionParams& params, Progress& progress) {
  std::vector<float> share(in.map.texels.size());
  LUXEL_TRY_STATUS(visit_points(
      in, hidden, params.points, hash64(params.seed, kOcclusionSeed), "ambient occlusion",
      [&](size_t texel, std::span<const Receiver> points) {
        thread_local std::vector<trace::Ray> rays;
        thread_local std::vector<uint8_t> blocked;
        rays.clear();
        // One sequence of directions for all points: it is well spread as a whole.
        const uint64_t seed = hash64(params.seed ^ kOcclusionSeed, texel);
        for (int k = 0; k < params.rays; ++k) {
          const Receiver& r = points[size_t(k) % points.size()];
          const Vec2 u = sobol_owen_2d(uint32_t(k), seed);
          const Vec3 d = frame_around(r.normal).to_world(cosine_hemisphere_sample(u));
          rays.push_back({r.position, 0, mirrored_above(d, r.geometric_normal), params.distance_m});
        }
        blocked.resize(rays.size());
        in.tracer.occluded(rays, blocked);
        const auto met = std::ranges::count_if(blocked, [](uint8_t b) { return b != 0; });
        share[texel] = 1 - float(met) / float(params.rays);
      },
      progress));
  return share;
}

}  // namespace luxel::light
