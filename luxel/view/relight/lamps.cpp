#include "luxel/view/relight/lamps.h"

#include <algorithm>

namespace luxel::view {

Lamps lamps_of(const matrix::RelightData& data) {
  Lamps out;
  for (const scene::PunctualLight& light : data.lights) out.lamps.push_back({light});
  const std::vector<Rgb> emission = matrix::mean_emission_of(data);
  for (size_t m = 0; m < emission.size(); ++m)
    out.glows.push_back({data.material_name[m], emission[m] / kPi});
  out.background = data.background;
  return out;
}

std::vector<scene::PunctualLight> shining(const Lamps& lamps) {
  std::vector<scene::PunctualLight> out;
  for (const Lamp& lamp : lamps.lamps)
    if (lamp.is_on) out.push_back(lamp.light);
  return out;
}

std::vector<Rgb> glowing(const Lamps& lamps) {
  std::vector<Rgb> out;
  for (const Glow& glow : lamps.glows) out.push_back(glow.is_on ? glow.radiance : Rgb{});
  return out;
}

bool has_light(const Lamps& lamps) {
  const auto is_bright = [](Rgb light) { return max_component(light) > 0; };
  const auto shines = [&](const scene::PunctualLight& l) { return is_bright(l.intensity); };
  return is_bright(lamps.background) || std::ranges::any_of(shining(lamps), shines) ||
         std::ranges::any_of(glowing(lamps), is_bright);
}

Rgb emission_now(const scene::Material& material, const Lamps& now, const Lamps& baked) {
  const auto channel = [](float own, float was, float is) { return was > 0 ? own / was * is : is; };
  for (size_t m = 0; m < now.glows.size(); ++m) {
    if (now.glows[m].name != material.name) continue;
    const Rgb own = material.emission, was = baked.glows[m].radiance;
    const Rgb is = now.glows[m].is_on ? now.glows[m].radiance : Rgb{};
    return {channel(own.x, was.x, is.x), channel(own.y, was.y, is.y), channel(own.z, was.z, is.z)};
  }
  return material.emission;
}

}  // namespace luxel::view
