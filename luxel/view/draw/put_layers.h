// Layers of light on a device.
#pragma once

#include <span>

#include "luxel/view/draw/device_scene.h"
#include "luxel/view/model/layers.h"

namespace luxel::view {

/// Shows `mixed`, which mixed_light() gave for these settings: the lightmap, and lamps and
/// surroundings that are seen. Light goes into the first (0) or second (1) pictures, which are then
/// shown. The scene was made with light_changes. Nothing may still draw it. Errors: no memory.
Status put_layers(gpu::Commands& commands, const Layers& layers,
                  std::span<const LayerSetting> settings, std::span<const image::Image> mixed,
                  uint32_t which, DeviceScene& scene);

}  // namespace luxel::view
