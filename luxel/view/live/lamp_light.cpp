#include "luxel/view/live/lamp_light.h"

#include <algorithm>

#include "luxel/light/supersample.h"

namespace luxel::view {
namespace {

light::Lights lamps_alone(const light::Lights& lights) {
  light::Lights out;
  out.punctual = lights.punctual, out.punctual_order = lights.punctual_order;
  out.punctual_nodes = lights.punctual_nodes, out.profiles = lights.profiles;
  return out;
}

bool has_profile(const scene::PunctualLight& lamp) { return lamp.profile != scene::kNone; }

}  // namespace

light::Lights without_lamps(const light::Lights& lights) {
  light::Lights out = lights;
  out.punctual.clear(), out.punctual_order.clear(), out.punctual_nodes.clear();
  return out;
}

bool is_dark(const light::Lights& lights) {
  return lights.triangles.empty() && lights.punctual.empty() && lights.around.bright_texels.empty();
}

Status tell_lamps_apart(const LampLightParams& params, KnownLight& known, Progress& progress) {
  known.of_lamps.clear();
  const light::Lights lamps = lamps_alone(light::collect_lights(known.scene));
  if (std::ranges::any_of(lamps.punctual, has_profile)) return {};
  if (lamps.punctual.empty()) {
    known.of_lamps.resize(known.map.texels.size());
    return {};
  }
  const transport::Elements elements =
      transport::elements_from_texels(known.scene, known.atlas, known.map);
  const light::SupersampleParams averaging{
      .points = params.supersample,
      .direct = {.samples = params.direct_samples, .seed = params.seed}};
  LUXEL_TRY(
      light::DirectLight direct,
      light::direct_light(known.scene, elements, lamps, *known.tracer, averaging.direct, progress));
  const light::TexelScene in{known.scene, known.atlas, known.map, elements, lamps, *known.tracer};
  if (auto averaged = light::supersample(in, averaging, direct, progress); !averaged)
    return Failure{averaged.error()};
  known.of_lamps = std::move(direct.irradiance);
  return {};
}

std::vector<Rgb> light_without_lamps(const KnownLight& known) {
  std::vector<Rgb> out;
  for (size_t i = 0; i < known.of_lamps.size(); ++i)
    out.push_back(max(known.irradiance[i] - known.of_lamps[i], Rgb{}));
  return out;
}

}  // namespace luxel::view
