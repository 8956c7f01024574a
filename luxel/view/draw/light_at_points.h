// Light straight from lamps at points of surfaces, by the maps of shadows that pixels look up.
#pragma once

#include <span>

#include "luxel/view/draw/device_scene.h"
#include "luxel/view/draw/points_shared.h"

namespace luxel::view {

using on_device::LitPoint;

/// Resources by which a device works out the light of points, for one scene.
struct LightAtPoints {
  gpu::Pipeline shader;
  gpu::BindingSets maps;
  gpu::Buffer points, irradiance;
  uint32_t count = 0;

  /// E of each point [W/m^2], of the last recording that the device is done with.
  std::span<const Rgb> result() const {
    return {reinterpret_cast<const Rgb*>(irradiance.mapped), count};
  }
};
/// True: a device takes so many at once.
bool can_light_points(const gpu::Device& device, size_t points);
/// There are points, no more than can be lit. Errors: no memory on the device.
Result<LightAtPoints> make_light_at_points(const gpu::Device& device, const DeviceScene& scene,
                                           std::span<const LitPoint> points);

/// Records what lights the points by the scene's lamps, after draw_shadow_maps().
void light_points(const gpu::Device& device, VkCommandBuffer commands, const DeviceScene& scene,
                  const LightAtPoints& at);

}  // namespace luxel::view
