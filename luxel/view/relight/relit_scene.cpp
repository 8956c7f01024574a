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
      follow_lamps(commands, opened.lamps, opened, out.direct, device).map([](LightTimes) {}));
  return out;
}

Result<LightTimes> follow_lamps(gpu::Commands& commands, const Lamps& lamps, OpenedLxr& opened,
                                DirectLight& direct, DeviceScene& scene) {
  const gpu::Device& device = commands.device();
  relight(lamps, opened.light);
  const RelitLight::Milliseconds& took = opened.light.took;
  LightTimes out{took.direct, took.bounces, took.places, took.map};
  const Clock::time_point start = Clock::now();
  show_glow(lamps, opened, scene);
  const std::array pages{image::to_half(opened.light.indirect)};
  LUXEL_TRY_STATUS(put_light(commands, pages, 0, scene));
  out.map += 1e3 * seconds_since(start);
  const Clock::time_point mapped = Clock::now();
  LUXEL_TRY_STATUS(set_lamps(device, shining(lamps), direct, scene));
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer buffer) { draw_shadow_maps(device, buffer, scene, direct); }));
  out.shadows = 1e3 * seconds_since(mapped);
  return out;
}

}  // namespace luxel::view
