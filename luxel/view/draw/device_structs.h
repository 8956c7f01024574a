// Values in the buffers of a DeviceScene.
#pragma once

#include <span>

#include "luxel/view/draw/device_scene.h"

namespace luxel::view {

/// The picture of a map.
inline image::HalfImage half_of(const scene::Environment& map) {
  image::Image image(map.width, map.height, 4);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      image.set_rgb(x, y, map.radiance[size_t(y) * size_t(map.width) + size_t(x)]);
  return image::to_half(image);
}

template <class Values>
std::span<const std::byte> bytes_of(const Values& values) {
  return std::as_bytes(std::span(values));
}

/// Per page, for either picture: E = scale * picture. They follow LightNow.
inline std::span<float> scales_of(const DeviceScene& scene) {
  return {reinterpret_cast<float*>(scene.light_now.mapped + sizeof(on_device::LightNow)),
          (scene.light_now.size - sizeof(on_device::LightNow)) / sizeof(float)};
}

}  // namespace luxel::view
