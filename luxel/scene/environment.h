// Light from all around: a picture of the surroundings, seen by rays that leave the scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"

namespace luxel::scene {

/// An equirectangular map of radiance [W/(sr m^2)]. Row 0 looks up (+Y). Unturned, column 0 begins
/// in the direction -X, a quarter of the width looks along -Z, half of it along +X: the place of a
/// direction d is  u = 1/2 + atan2(d.z, d.x) / 2 pi,  v = acos(d.y) / pi,  as three.js and Blender
/// have it. Light is constant over a pixel: what is sampled is what is there, to the last bit.
struct Environment {
  int width = 0, height = 0;
  std::vector<Rgb> radiance;  ///< width * height, row by row, finite and >= 0; empty: no map
  float rotation_rad = 0;     ///< about +Y, as a compass turns: pi/2 moves what stood at -Z to +X

  /// True when there is no map: nothing shines.
  bool empty() const { return radiance.empty(); }
};

/// The place of a unit direction, in [0, 1) x [0, 1].
Vec2 uv_of(const Environment& map, Vec3 direction);
/// The unit direction of a place; the inverse of uv_of.
Vec3 direction_of(const Environment& map, Vec2 uv);

/// The pixel in which a unit direction lies.
size_t pixel_towards(const Environment& map, Vec3 direction);
/// The pixels of many directions. The spans have one length.
void pixels_towards(const Environment& map, std::span<const Vec3> directions,
                    std::span<uint32_t> pixels);
/// Radiance in the pixel of a unit direction [W/(sr m^2)]; the map is not empty.
inline Rgb radiance_towards(const Environment& map, Vec3 direction) {
  return map.radiance[pixel_towards(map, direction)];
}
/// Radiance interpolated between the centres of pixels: for pictures, in which a pixel of the map
/// may be large.
Rgb smooth_radiance_towards(const Environment& map, Vec3 direction);

/// Solid angle of every pixel of a row [sr]; the rows' sum times the width is 4 pi.
double pixel_solid_angle(const Environment& map, int row);

/// E on a horizontal surface that faces up [W/m^2], nothing in between.
Rgb horizontal_irradiance(const Environment& map);

}  // namespace luxel::scene
