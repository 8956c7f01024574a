#include "luxel/scene/environment.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/vec_double.h"
#include "luxel/base/vectorize.h"
#include "luxel/scene/both_environment.h"

namespace luxel::scene {
namespace {

LUXEL_VECTOR_CLONES
void find_pixels(int width, int height, float rotation_rad, const Vec3* direction, uint32_t* pixel,
                 size_t count) {
  for (size_t i = 0; i < count; ++i)
    pixel[i] = both::pixel_of_environment(width, height,
                                          both::place_in_environment(rotation_rad, direction[i]));
}

}  // namespace

Vec2 uv_of(const Environment& map, Vec3 d) {
  return both::place_in_environment(map.rotation_rad, d);
}

Vec3 direction_of(const Environment& map, Vec2 uv) {
  const float phi = 2 * kPi * (uv.x - 0.5f) + map.rotation_rad, theta = kPi * uv.y;
  const float s = std::sin(theta);
  return {s * std::cos(phi), std::cos(theta), s * std::sin(phi)};
}

size_t pixel_towards(const Environment& map, Vec3 direction) {
  return both::pixel_of_environment(map.width, map.height, uv_of(map, direction));
}

void pixels_towards(const Environment& map, std::span<const Vec3> directions,
                    std::span<uint32_t> pixels) {
  LUXEL_CHECK(directions.size() == pixels.size());
  find_pixels(map.width, map.height, map.rotation_rad, directions.data(), pixels.data(),
              pixels.size());
}

Rgb smooth_radiance_towards(const Environment& map, Vec3 direction) {
  const Vec2 uv = uv_of(map, direction);
  const float x = uv.x * float(map.width) - 0.5f;
  const float y = std::clamp(uv.y * float(map.height) - 0.5f, 0.0f, float(map.height - 1));
  const int x0 = int(std::floor(x)), y0 = int(y);
  const float fx = x - float(x0), fy = y - float(y0);
  const int left = x0 < 0 ? map.width - 1 : x0, right = x0 + 1 < map.width ? x0 + 1 : 0;
  const auto row = [&](int number) {
    const Rgb* pixels = &map.radiance[size_t(std::min(number, map.height - 1)) * size_t(map.width)];
    return pixels[left] * (1 - fx) + pixels[right] * fx;
  };
  return row(y0) * (1 - fy) + row(y0 + 1) * fy;
}

double pixel_solid_angle(const Environment& map, int row) {
  // 2 pi / width (cos above - cos below), without its cancellation.
  const double half = kPiDouble / (2 * map.height), middle = kPiDouble * (row + 0.5) / map.height;
  return 4 * kPiDouble / map.width * std::sin(middle) * std::sin(half);
}

Rgb horizontal_irradiance(const Environment& map) {
  double r = 0, g = 0, b = 0;
  for (int y = 0; y < map.height / 2; ++y) {
    // The cosine over a row's solid angle: sin^2 / 2 between its polar angles.
    const double from = std::sin(kPiDouble * y / map.height);
    const double to = std::sin(kPiDouble * (y + 1) / map.height);
    const double weight = 2 * kPiDouble / map.width * (to * to - from * from) / 2;
    for (int x = 0; x < map.width; ++x) {
      const Rgb l = map.radiance[size_t(y) * size_t(map.width) + size_t(x)];
      r += double(l.x) * weight, g += double(l.y) * weight, b += double(l.z) * weight;
    }
  }
  return {float(r), float(g), float(b)};
}

}  // namespace luxel::scene
