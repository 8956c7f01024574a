// Structs in the buffers of a DeviceScene: those of shaders/surface.glsl, in scalar layout.
#pragma once

#include <array>
#include <span>

#include "luxel/view/draw/device_scene.h"

namespace luxel::view {

struct DeviceVertex {
  Vec3 position;
  Vec2 uv0, uv1;
  Vec2 light, light_behind;  ///< places in the lightmap: its own, that of the other side
  Vec3 normal;               ///< 0: that of the facet
  Rgb color;
  float clear = 0;  ///< 1 - alpha
};
static_assert(sizeof(DeviceVertex) == 72);

struct DeviceLookUp {
  Vec3 u{1, 0, 0}, v{0, 1, 0};
  uint32_t uv_set = 0;
};

struct DeviceMaterial {
  Rgb base_color;
  float alpha = 1;
  Rgb emission;
  float metallic = 0;
  float cutoff = 0;   ///< alpha below it is a hole
  uint32_t page = 0;  ///< of the lightmap
  uint32_t unlit = 0;
  Rgb through_color;  ///< of light that is scattered through
  float through = 0;
  DeviceLookUp map, metal, glow, through_share, through_tint;
};
static_assert(sizeof(DeviceMaterial) == 60 + 5 * 28);

struct DeviceInstance {
  std::array<float, 12> rows{};  ///< world from object, three rows of four
  Rgb emission_factor{1, 1, 1};
};
static_assert(sizeof(DeviceInstance) == 60);

/// Row by row.
inline std::array<float, 12> rows_of(const Mat34& m) {
  std::array<float, 12> out;
  for (size_t i = 0; i < 12; ++i) out[i] = m.row[i / 4][i % 4];
  return out;
}

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
  return {reinterpret_cast<float*>(scene.light_now.mapped + sizeof(LightNow)),
          (scene.light_now.size - sizeof(LightNow)) / sizeof(float)};
}

}  // namespace luxel::view
