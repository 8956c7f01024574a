#include "luxel/light/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/vec_double.h"
#include "luxel/light/both_bright_texel.h"
#include "luxel/scene/environment.h"

namespace luxel::light {
namespace {

/// Light of up to so many times the mean is left to rays with the density of the cosine: a sky's
/// gradient and its clouds, not its sun.
constexpr double kBrightTexel = 4;

/// The limit that is kBrightTexel times the mean of min(L, limit): from above, until it stays.
double limit_of(const scene::Environment& map) {
  double limit = HUGE_VAL;
  for (int round = 0; round < 64; ++round) {
    double sum = 0;
    for (int y = 0; y < map.height; ++y) {
      double row = 0;
      for (int x = 0; x < map.width; ++x)
        row += std::min(limit,
                        double(luminance(map.radiance[size_t(y) * size_t(map.width) + size_t(x)])));
      sum += row * scene::pixel_solid_angle(map, y);
    }
    const double next = kBrightTexel * sum / (4 * kPiDouble);
    if (next >= limit * (1 - 1e-3)) break;
    limit = next;
  }
  return limit;
}

/// Places near each other in this order lie near each other in the map, so that points spread
/// evenly over the order spread over the map.
uint64_t morton(uint32_t x, uint32_t y) {
  uint64_t code = 0;
  for (int bit = 0; bit < 32; ++bit)
    code |= (uint64_t(x >> bit & 1) << (2 * bit)) | (uint64_t(y >> bit & 1) << (2 * bit + 1));
  return code;
}

/// Share of a pixel's light that lies below the limit.
float soft_share(float luminance_of_pixel, float limit) {
  return luminance_of_pixel > limit ? limit / luminance_of_pixel : 1.0f;
}

Rgb soft_part(const Surroundings& s, Rgb l) {
  return s.background + l * soft_share(luminance(l), s.limit);
}

/// Where in `below` the search for a part of the power begins: for so many parts as there are
/// bright texels.
std::vector<uint32_t> guide_of(std::span<const double> below) {
  const size_t count = below.size() - 1;
  std::vector<uint32_t> out(count);
  uint32_t k = 0;
  for (size_t part = 0; part < count; ++part) {
    // Not beyond, whatever is rounded.
    const double at = (double(part) / double(count) - 1e-12) * below.back();
    while (k + 1 < count && below[k + 1] <= at) ++k;
    out[part] = k;
  }
  return out;
}

/// The bright texel at a part u of the power, in [0, 1).
size_t bright_texel_at(const Surroundings& s, double u) {
  const double at = u * s.below.back();
  size_t k = s.guide[size_t(u * double(s.bright_texels.size()))];
  while (k + 1 < s.bright_texels.size() && s.below[k + 1] <= at) ++k;
  return k;
}

}  // namespace

Surroundings surroundings_of(const scene::Scene& scene) {
  Surroundings out;
  out.background = scene.background;
  const scene::Environment& map = scene.environment;
  if (map.empty()) return out;
  out.limit = float(limit_of(map));
  for (int y = 0; y <= map.height; ++y)
    out.row_cosine.push_back(std::cos(kPiDouble * y / map.height));
  for (uint32_t i = 0; i < map.radiance.size(); ++i)
    if (luminance(map.radiance[i]) > out.limit) out.bright_texels.push_back(i);
  const auto code = [&](uint32_t i) {
    return morton(i % uint32_t(map.width), i / uint32_t(map.width));
  };
  std::sort(out.bright_texels.begin(), out.bright_texels.end(),
            [&](uint32_t a, uint32_t b) { return code(a) < code(b); });
  out.below.push_back(0);
  for (const uint32_t i : out.bright_texels) {
    const double over = double(luminance(map.radiance[i])) - double(out.limit);
    out.below.push_back(out.below.back() +
                        over * scene::pixel_solid_angle(map, int(i) / map.width));
  }
  out.guide = guide_of(out.below);
  return out;
}

Rgb soft_radiance(const scene::Scene& scene, const Surroundings& s, Vec3 direction) {
  if (scene.environment.empty()) return s.background;
  return soft_part(s, scene::radiance_towards(scene.environment, direction));
}

void soft_radiance(const scene::Scene& scene, const Surroundings& s,
                   std::span<const Vec3> directions, std::vector<Rgb>& out) {
  out.assign(directions.size(), s.background);
  if (scene.environment.empty()) return;
  constexpr size_t kAtOnce = 64;
  std::array<uint32_t, kAtOnce> pixel;
  for (size_t begin = 0; begin < directions.size(); begin += kAtOnce) {
    const size_t count = std::min(kAtOnce, directions.size() - begin);
    scene::pixels_towards(scene.environment, directions.subspan(begin, count),
                          std::span(pixel).first(count));
    for (size_t k = 0; k < count; ++k)
      out[begin + k] = soft_part(s, scene.environment.radiance[pixel[k]]);
  }
}

BrightTexelSample sample_bright_texels(const scene::Scene& scene, const Surroundings& s, Vec2 u) {
  LUXEL_CHECK(!s.bright_texels.empty());
  const scene::Environment& map = scene.environment;
  const double power = s.below.back();
  const double at = double(u.x) * power;
  const size_t k = bright_texel_at(s, double(u.x));
  // The rest of u.x within the pixel's share is uniform again.
  const double within = std::clamp((at - s.below[k]) / (s.below[k + 1] - s.below[k]), 0.0, 1.0);
  const uint32_t pixel = s.bright_texels[k];
  const int x = int(pixel) % map.width, y = int(pixel) / map.width;
  // Uniform over the pixel's solid angle: linear in the cosine of the angle from up.
  const double upper = s.row_cosine[size_t(y)], lower = s.row_cosine[size_t(y) + 1];
  const double up = upper + (lower - upper) * double(u.y);
  const Vec3 direction =
      both::direction_in_column(map.width, map.rotation_rad, x, float(within), up);
  const Rgb l = map.radiance[pixel];
  const float l_luminance = luminance(l);
  // Density = (lum L - limit) / power per steradian, radiance = L (lum L - limit) / lum L.
  return {direction, l * float(power / double(l_luminance))};
}

}  // namespace luxel::light
