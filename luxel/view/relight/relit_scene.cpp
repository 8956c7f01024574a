#include "luxel/view/relight/relit_scene.h"

#include "luxel/base/clock.h"

namespace luxel::view {
namespace {

/// 64 MB for the shadows of all lamps.
constexpr uint32_t kShadowSide = 4096;

/// What the eye sees of glowing materials and of the background.
void show_glow(const Lamps& lamps, const OpenedLxr& opened, DeviceScene& scene) {
  const std::vector<scene::Material>& materials = opened.read->scene.materials;
  for (size_t m = 0; m < materials.size(); ++m)
    set_emission(m, emission_now(materials[m], lamps, opened.lamps), scene);
  scene.background = lamps.background;
}

/// Returns what it took [ms].
Result<double> draw_shadows(gpu::Commands& commands,
                            const std::vector<scene::PunctualLight>& lights,
                            const trace::CameraRays* eye, DirectLight& direct, DeviceScene& scene) {
  const Clock::time_point start = Clock::now();
  const gpu::Device& device = commands.device();
  LUXEL_TRY_STATUS(set_lamps(device, lights, eye, direct, scene));
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer buffer) { draw_shadow_maps(device, buffer, scene, direct); }));
  return 1e3 * seconds_since(start);
}

}  // namespace

Result<RelitScene> lxr_shown(gpu::Commands& commands, OpenedLxr& opened) {
  const std::array pages{image::to_half(opened.light.indirect)};
  const std::vector<size_t> of_material(opened.read->scene.materials.size(), 0);
  DeviceSceneParams params;
  params.light_changes = true, params.shadow_side = kShadowSide;
  RelitScene out;
  DeviceScene& device = out.shown.device;
  LUXEL_TRY(device, put_on_device(commands, opened.read->scene, {pages, of_material}, params));
  out.shown.read = opened.read;
  out.shown.fade.exposure_before = out.shown.fade.exposure_newest = opened.read->first.exposure;
  out.shown.has_light = out.shown.has_last = true;
  LUXEL_TRY(out.direct, make_direct_light(commands.device(), device));
  LUXEL_TRY_STATUS(
      follow_lamps(commands, opened.lamps, nullptr, opened, out.direct, device).map([](LightTimes) {
      }));
  return out;
}

Result<LightTimes> follow_lamps(gpu::Commands& commands, const Lamps& lamps,
                                const trace::CameraRays* eye, OpenedLxr& opened,
                                DirectLight& direct, DeviceScene& scene) {
  relight(lamps, opened.light);
  const RelitLight::Milliseconds& took = opened.light.took;
  LightTimes out{took.direct, took.bounces, took.places, took.map};
  const Clock::time_point start = Clock::now();
  show_glow(lamps, opened, scene);
  const std::array pages{image::to_half(opened.light.indirect)};
  LUXEL_TRY_STATUS(put_light(commands, pages, 0, scene));
  out.map += 1e3 * seconds_since(start);
  LUXEL_TRY(out.shadows, draw_shadows(commands, shining(lamps), eye, direct, scene));
  return out;
}

Result<double> follow_eye(gpu::Commands& commands, const Lamps& lamps, const trace::CameraRays& eye,
                          DirectLight& direct, DeviceScene& scene) {
  const std::vector<scene::PunctualLight> lights = shining(lamps);
  const uint32_t side = scene.shadow_maps.picture->params.width;
  if (plan_shadows(lights, scene.bounds, side, &eye).maps == direct.drawn) return 0;
  return draw_shadows(commands, lights, &eye, direct, scene);
}

}  // namespace luxel::view
