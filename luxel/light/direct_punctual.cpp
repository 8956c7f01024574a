// Shadow rays towards punctual lights, the sun's disc among them.
#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/light/both_punctual_light.h"
#include "luxel/light/shadow_rays.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::light {
namespace {

/// The directional light of that number, whose disc has some size: directions uniform in its cone.
void aim_at_disc(const Lights& lights, size_t index, uint32_t source, int samples,
                 const Receiver& r, ShadowRayBatch& batch) {
  const scene::PunctualLight& light = lights.punctual[index];
  const Frame frame = frame_around(-light.direction);
  // 1 - cos(angle) without cancellation.
  const float s = std::sin(0.5f * light.angular_radius_rad);
  const float height = 2 * s * s;
  for (int k = 0; k < samples; ++k) {
    const Vec2 u = sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x5000 + index));
    const float phi = 2 * kPi * u.x;
    const Vec3 d =
        frame.to_world(both::direction_in_disc(height, u, {std::cos(phi), std::sin(phi)}));
    const float w = std::max(0.0f, dot(d, r.normal));
    if (w > 0) add_shadow_ray(batch, r, {source, w, Rgb{1, 1, 1} * w}, d, INFINITY);
  }
}

void aim_at_punctual(const Lights& lights, size_t index, float chance, int samples,
                     const Receiver& r, ShadowRayBatch& batch) {
  const scene::PunctualLight& light = lights.punctual[index];
  const PunctualIncidence in = incidence_at(light, lights.profiles, r.position);
  const float cosine = dot(in.towards, r.normal);
  const bool disc = scene::has_disc(light);
  if (max_component(in.irradiance) <= 0 || (cosine <= 0 && !disc)) return;
  const uint32_t source = uint32_t(batch.sources.size());
  batch.sources.push_back({});
  Source& s = batch.sources.back();
  s.exact = true;
  s.light = {LightId::Kind::punctual, uint32_t(index)};
  s.planned = disc ? uint32_t(samples) : 1;
  if (disc)
    aim_at_disc(lights, index, source, samples, r, batch);
  else
    add_shadow_ray(batch, r, {source, 1, {1, 1, 1}}, in.towards, in.reach_m);
  // Over the disc the cosine averages to that of its centre while all of it is above the horizon.
  const float seen = disc ? batch.sources[source].sum_weight / float(samples) : cosine;
  const bool whole = disc && batch.sources[source].rays == uint32_t(samples);
  batch.sources[source].scale = (whole ? std::max(cosine, 0.0f) : seen) / chance;
  batch.sources[source].unshadowed = luminance(in.irradiance) * batch.sources[source].scale;
  batch.sources[source].tint = in.irradiance;
  batch.sources[source].drawn = chance < 1;
}

}  // namespace

void aim_at_punctual_lights(const Lights& lights, int samples, const Receiver& r,
                            ShadowRayBatch& batch) {
  const size_t count = lights.punctual.size();
  if (count <= both::kMaxAllPunctual) {
    for (size_t i = 0; i < count; ++i) aim_at_punctual(lights, i, 1, samples, r, batch);
    return;
  }
  for (size_t i = 0; i < count; ++i)
    if (!scene::has_position(lights.punctual[i].kind))
      aim_at_punctual(lights, i, 1, samples, r, batch);
  if (lights.punctual_nodes.empty()) return;
  const auto leaf = [&](const LightNode& node) {
    const auto in = incidence_at(lights.punctual[lights.punctual_order[node.first]],
                                 lights.profiles, r.position);
    return luminance(in.irradiance) * std::max(0.0f, dot(in.towards, r.normal));
  };
  RandomStream random{hash64(r.seed, 0x12)};
  draw_lights(lights.punctual_nodes, r.position, r.normal, leaf,
              {.samples = int(both::kMaxAllPunctual), .start = random.next()}, batch.draws);
  for (const LightDraw& draw : batch.draws.draws)
    aim_at_punctual(lights, lights.punctual_order[draw.light], draw.chance, samples, r, batch);
}

}  // namespace luxel::light
