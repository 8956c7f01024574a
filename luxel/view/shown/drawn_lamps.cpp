#include "luxel/view/shown/drawn_lamps.h"

#include "luxel/view/edit/pick.h"

namespace luxel::view {

std::vector<scene::PunctualLight> shining(const SceneNow& now) {
  std::vector<scene::PunctualLight> out;
  for (const EditedLamp& lamp : now.lamps)
    if (lamp.is_on && !lamp.is_deleted) out.push_back(lamp.light);
  return out;
}

namespace {

/// Moved instances may stand beyond the bounds that the scene had when it was put on the device.
void widen_bounds(const SceneNow& now, const std::vector<Mat34>& before, ShownScene& shown) {
  const scene::Scene& scene = shown.drawn();
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Mat34& to_world = now.world_from_object[i];
    if (i < before.size() && before[i] == to_world) continue;
    const Box3 box = placed_bounds(scene.meshes[scene.instances[i].mesh], to_world);
    if (box.empty()) continue;
    shown.device.bounds.extend(box.lower), shown.device.bounds.extend(box.upper);
  }
}

}  // namespace

Status draw_lamps(gpu::Commands& commands, const SceneNow& now, const trace::CameraRays& eye,
                  ShownScene& shown, DrawnLamps& drawn) {
  const gpu::Device& device = commands.device();
  DeviceScene& scene = shown.device;
  light_now(scene).lamp_share = lamp_share(shown);
  light_now(scene).lamp_count = 0;
  if (lamp_share(shown) <= 0) return {};
  if (!drawn.direct) {
    LUXEL_TRY(drawn.direct, make_direct_light(device, scene));
  }
  if (drawn.world_from_object != now.world_from_object) {
    widen_bounds(now, drawn.world_from_object, shown);
    drawn.direct->drawn.clear();
    drawn.world_from_object = now.world_from_object;
  }
  LUXEL_TRY_STATUS(set_lamps(device, shining(now), &eye, *drawn.direct, scene));
  if (drawn.direct->plan.maps == drawn.direct->drawn) return {};
  return commands.run(
      [&](VkCommandBuffer buffer) { draw_shadow_maps(device, buffer, scene, *drawn.direct); });
}

}  // namespace luxel::view
