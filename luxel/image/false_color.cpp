#include "luxel/image/false_color.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/vec.h"
#include "luxel/base/vec_double.h"
#include "luxel/image/color.h"

namespace luxel::image {
namespace {

/// Oklab, a space in which lightness L in [0, 1] is even for the eye, to linear sRGB. [Ottosson20]
std::array<double, 3> rgb_from_oklab(double lightness, double a, double b) {
  const auto cube = [](double v) { return v * v * v; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

/// The colour of this lightness and hue whose chroma is the wanted one, or what a screen can show.
Color8 color_of(double lightness, double chroma, double hue_rad) {
  std::array<double, 3> rgb{};
  for (;; chroma *= 0.995) {
    rgb = rgb_from_oklab(lightness, chroma * std::cos(hue_rad), chroma * std::sin(hue_rad));
    const auto [least, most] = std::minmax_element(rgb.begin(), rgb.end());
    if ((*least >= 0 && *most <= 1) || chroma < 1e-4) break;
  }
  Color8 out{};
  for (size_t c = 0; c < 3; ++c) {
    const float v = srgb_from_linear(float(std::clamp(rgb[c], 0.0, 1.0)));
    out[c] = uint8_t(v * 255 + 0.5f);
  }
  return out;
}

Color8 checker(size_t x, size_t y) {
  const uint8_t v = (x / 8 + y / 8) % 2 ? 136 : 120;
  return {v, v, v};
}

/// A picture whose covered pixels have the colour of color_at(pixel index).
template <class Function>
Image8 paint(size_t width, const Mask& covered, const Function& color_at) {
  LUXEL_CHECK(width > 0 && covered.size() % width == 0);
  Image8 out{int(width), int(covered.size() / width), 3, {}};
  out.data.resize(3 * covered.size());
  for (size_t i = 0; i < covered.size(); ++i) {
    const Color8 c = covered[i] ? color_at(i) : checker(i % width, i / width);
    std::copy(c.begin(), c.end(), out.data.begin() + std::ptrdiff_t(3 * i));
  }
  return out;
}

}  // namespace

Color8 false_color(double t) {
  t = t > 0 ? std::min(t, 1.0) : 0.0;
  const double lightness = 0.14 + 0.83 * t;
  const double chroma = 0.21 * std::sin(kPiDouble * (0.12 + 0.72 * t));
  const double hue_deg = 285 + 180 * t;  // violet, then through red (29) to yellow (105)
  return color_of(lightness, chroma, hue_deg * kPiDouble / 180);
}

Image8 draw_map(const Image& map, const Mask& covered, double low, double high) {
  LUXEL_CHECK(map.channels == 1 && map.data.size() == covered.size() && high > low);
  std::array<Color8, 256> table;
  for (size_t i = 0; i < table.size(); ++i) table[i] = false_color(double(i) / 255);
  return paint(size_t(map.width), covered, [&](size_t i) {
    const double t = (double(map.data[i]) - low) / (high - low);
    return table[size_t(std::clamp(t, 0.0, 1.0) * 255 + 0.5)];
  });
}

Color8 contour_color(size_t index, size_t count) {
  const double t = count > 1 ? double(index) / double(count - 1) : 0;
  return color_of(0.55 + 0.2 * t, 0.2, (264 + 215 * t) * kPiDouble / 180);
}

Image8 draw_contours(std::span<const uint8_t> contours, std::span<const uint8_t> brightness,
                     int width, const Mask& covered, size_t level_count) {
  LUXEL_CHECK(contours.size() == covered.size() && brightness.size() == covered.size());
  return paint(size_t(width), covered, [&](size_t i) -> Color8 {
    if (contours[i]) return contour_color(contours[i] - 1u, level_count);
    const uint8_t faded = uint8_t(10 + brightness[i] / 5);
    return {faded, faded, faded};
  });
}

Image8 draw_threshold(std::span<const uint8_t> differences, int width, const Mask& covered,
                      uint8_t level) {
  LUXEL_CHECK(differences.size() == covered.size());
  return paint(size_t(width), covered, [&](size_t i) -> Color8 {
    const uint8_t v = differences[i] > level ? 0 : 255;
    return {v, v, v};
  });
}

Image8 draw_covered(const Image8& picture, const Mask& covered) {
  LUXEL_CHECK(picture.channels >= 3);
  LUXEL_CHECK(picture.data.size() == size_t(picture.channels) * covered.size());
  return paint(size_t(picture.width), covered, [&](size_t i) -> Color8 {
    const uint8_t* p = picture.data.data() + size_t(picture.channels) * i;
    return {p[0], p[1], p[2]};
  });
}

}  // namespace luxel::image
