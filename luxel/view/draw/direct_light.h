// Lamps on a graphics device: their light is drawn per pixel, with shadows from maps.
#pragma once

#include <span>

#include "luxel/view/draw/device_scene.h"
#include "luxel/view/draw/shadow_maps.h"

namespace luxel::view {

/// Lamps and what draws their shadow maps, for one scene.
struct DirectLight {
  gpu::Pipeline solid, masked;
  gpu::BindingSets colour_maps;  ///< of each material, for holes
  gpu::Buffer lamps, maps;       ///< on_device::Lamp and ShadowMap
  ShadowPlan plan;
  std::vector<ShadowMap> drawn;  ///< what the picture of the maps holds
};
Result<DirectLight> make_direct_light(const gpu::Device& device, const DeviceScene& scene);

/// These lamps light the scene from the next picture on: point, spot and directional, without
/// profiles. Shadows of a sun have edges as soft as its disc makes them; what faces it is lit as if
/// by its centre. Shadows of suns are sharp near to the eye, if there is one. Nothing may still
/// draw the scene. Errors: no memory.
Status set_lamps(const gpu::Device& device, std::span<const scene::PunctualLight> lamps,
                 const trace::CameraRays* eye, DirectLight& direct, DeviceScene& scene);

/// Records the drawing of those maps that have changed, before the scene itself is drawn.
void draw_shadow_maps(const gpu::Device& device, VkCommandBuffer commands, const DeviceScene& scene,
                      DirectLight& direct);

}  // namespace luxel::view
