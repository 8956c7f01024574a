// Shadow rays towards lamps without area and suns.
#include <algorithm>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/direct_shots.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::light {
namespace {

constexpr size_t kMaxPunctual = 64;

/// The directional light of that number, whose disc has some size: directions uniform in its cone.
void shoot_at_disc(const Lights& lights, size_t index, uint32_t source, int samples,
                   const Receiver& r, Shots& shots) {
  const scene::PunctualLight& light = lights.punctual[index];
  const Frame frame = frame_around(-light.direction);
  // 1 - cos(angle) without cancellation.
  const float s = std::sin(0.5f * light.angular_radius_rad);
  const float height = 2 * s * s;
  for (int k = 0; k < samples; ++k) {
    const Vec2 u = sobol_owen_2d(uint32_t(k), hash64(r.seed, 0x5000 + index));
    const float down = u.y * height, radius = std::sqrt(std::max(0.0f, down * (2 - down)));
    const float phi = 2 * kPi * u.x;
    const Vec3 d = frame.to_world({radius * std::cos(phi), radius * std::sin(phi), 1 - down});
    const float w = std::max(0.0f, dot(d, r.normal));
    if (w > 0) add_shot(shots, r, {source, w, Rgb{1, 1, 1} * w}, d, INFINITY);
  }
}

void shoot_at_punctual(const Lights& lights, size_t index, float chance, int samples,
                       const Receiver& r, Shots& shots) {
  const scene::PunctualLight& light = lights.punctual[index];
  const PunctualIncidence in = incidence_at(light, lights.profiles, r.position);
  const float cosine = dot(in.towards, r.normal);
  const bool disc = scene::has_disc(light);
  if (max_component(in.irradiance) <= 0 || (cosine <= 0 && !disc)) return;
  const uint32_t source = uint32_t(shots.sources.size());
  shots.sources.push_back({});
  Source& s = shots.sources.back();
  s.exact = true;
  s.light = {LightId::Kind::punctual, uint32_t(index)};
  s.planned = disc ? uint32_t(samples) : 1;
  if (disc)
    shoot_at_disc(lights, index, source, samples, r, shots);
  else
    add_shot(shots, r, {source, 1, {1, 1, 1}}, in.towards,
             std::isfinite(in.distance_m) ? in.distance_m * (1 - 1e-5f) : INFINITY);
  // Over the disc the cosine averages to that of its centre while all of it is above the horizon.
  const float seen = disc ? shots.sources[source].sum_weight / float(samples) : cosine;
  const bool whole = disc && shots.sources[source].shots == uint32_t(samples);
  shots.sources[source].scale = (whole ? std::max(cosine, 0.0f) : seen) / chance;
  shots.sources[source].unshadowed = luminance(in.irradiance) * shots.sources[source].scale;
  shots.sources[source].tint = in.irradiance;
  shots.sources[source].drawn = chance < 1;
}

}  // namespace

void shoot_at_lamps(const Lights& lights, int samples, const Receiver& r, Shots& shots) {
  const size_t count = lights.punctual.size();
  if (count <= kMaxPunctual) {
    for (size_t i = 0; i < count; ++i) shoot_at_punctual(lights, i, 1, samples, r, shots);
    return;
  }
  for (size_t i = 0; i < count; ++i)
    if (!scene::has_position(lights.punctual[i].kind))
      shoot_at_punctual(lights, i, 1, samples, r, shots);
  if (lights.lamp_nodes.empty()) return;
  const auto leaf = [&](const LightNode& node) {
    const auto in =
        incidence_at(lights.punctual[lights.lamp_order[node.first]], lights.profiles, r.position);
    return luminance(in.irradiance) * std::max(0.0f, dot(in.towards, r.normal));
  };
  RandomStream random{hash64(r.seed, 0x12)};
  draw_lights(lights.lamp_nodes, r.position, r.normal, leaf,
              {.samples = int(kMaxPunctual), .start = random.next()}, shots.draws);
  for (const LightDraw& draw : shots.draws.draws)
    shoot_at_punctual(lights, lights.lamp_order[draw.light], draw.chance, samples, r, shots);
}

}  // namespace luxel::light
