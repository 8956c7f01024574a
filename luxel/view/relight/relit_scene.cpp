#include "luxel/view/relight/relit_scene.h"

namespace luxel::view {
namespace {

/// 64 MB for the shadows of all lamps.
constexpr uint32_t kShadowSide = 4096;

/// What the eye sees of glowing materials and of the background.
void show_glow(const Lamps& lamps, const OpenedLxr& opened, DeviceScene& scene) {
  for (size_t m = 0; m < opened.scene.materials.size(); ++m)
    set_emission(m, emission_now(opened.scene.materials[m], lamps, opened.lamps), scene);
  scene.background = lamps.background;
}

}  // namespace

Result<RelitScene> put_on_device(gpu::Commands& commands, OpenedLxr& opened) {
  pipeline::LightmapPages indirect;
  indirect.pictures = {opened.light.indirect};
  indirect.of_material.assign(opened.scene.materials.size(), 0);
  DeviceSceneParams params;
  params.light_changes = true, params.shadow_side = kShadowSide;
  RelitScene out;
  LUXEL_TRY(out.scene, put_on_device(commands, opened.scene, indirect, params));
  LUXEL_TRY(out.direct, make_direct_light(commands.device(), out.scene));
  LUXEL_TRY_STATUS(follow_lamps(commands, opened.lamps, opened, out));
  return out;
}

Status follow_lamps(gpu::Commands& commands, const Lamps& lamps, OpenedLxr& opened,
                    RelitScene& relit) {
  const gpu::Device& device = commands.device();
  relight(lamps, opened.light);
  show_glow(lamps, opened, relit.scene);
  const std::array pages{image::to_half(opened.light.indirect)};
  LUXEL_TRY_STATUS(put_light(commands, pages, 0, relit.scene));
  LUXEL_TRY_STATUS(set_lamps(device, shining(lamps), relit.direct, relit.scene));
  return commands.run(
      [&](VkCommandBuffer buffer) { draw_shadow_maps(device, buffer, relit.scene, relit.direct); });
}

}  // namespace luxel::view
