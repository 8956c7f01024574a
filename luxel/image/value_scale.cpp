#include "luxel/image/value_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "luxel/base/check.h"
#include "luxel/image/text.h"

namespace luxel::image {
namespace {

/// The steps of illuminance of EN 12464-1 within a decade.
constexpr std::array<double, 6> kSteps{1, 1.5, 2, 3, 5, 7.5};
constexpr size_t kMostLevels = 10, kFewestLevels = 4;
constexpr double kBelowTop = 0.98;
constexpr Color8 kInk{20, 20, 20}, kPaper{255, 255, 255};
constexpr int kLegendWidth = 110, kBarWidth = 22, kMargin = 10, kTextScale = 1;
/// Labels keep so far apart [pixels].
constexpr int kApart = 46;

/// The steps of all decades from the first one at or above `low` to the last one at or below
/// `high`.
std::vector<double> steps_between(double low, double high) {
  std::vector<double> out;
  for (int decade = int(std::floor(std::log10(low))); std::pow(10.0, decade) <= high; ++decade)
    for (const double step : kSteps) {
      const double value = step * std::pow(10.0, decade);
      if (value >= low && value <= high) out.push_back(value);
    }
  return out;
}

/// Multiples of a round number, some six of them.
std::vector<double> multiples_between(double low, double high) {
  const double wanted = (high - low) / 6, decade = std::pow(10.0, std::floor(std::log10(wanted)));
  const double step = wanted > 5 * decade   ? 10 * decade
                      : wanted > 2 * decade ? 5 * decade
                      : wanted > decade     ? 2 * decade
                                            : decade;
  std::vector<double> out;
  for (double k = std::ceil(low / step); k * step <= high; ++k) out.push_back(k * step);
  return out;
}

/// The number of levels at or below a value; none where it is not finite.
std::optional<size_t> band_of(double value, const ValueScale& scale) {
  if (!std::isfinite(value)) return std::nullopt;
  return size_t(std::upper_bound(scale.levels.begin(), scale.levels.end(), value) -
                scale.levels.begin());
}

void set_pixel(Image8& picture, int x, int y, Color8 color) {
  uint8_t* pixel = picture.data.data() +
                   size_t(picture.channels) * (size_t(y) * size_t(picture.width) + size_t(x));
  std::copy(color.begin(), color.end(), pixel);
}

void fill(Image8& picture, int x0, int y0, int x1, int y1, Color8 color) {
  for (int y = std::max(y0, 0); y < std::min(y1, picture.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, picture.width); ++x)
      set_pixel(picture, x, y, color);
}

/// Ink that is seen on the colour of t.
Color8 line_color(double t) { return t < 0.55 ? kPaper : kInk; }

}  // namespace

std::string text_of_value(double value) { return fmt::format("{:.6g}", value); }

ValueScale scale_for(std::span<const float> values, std::string_view unit) {
  std::vector<float> sorted;
  for (const float v : values)
    if (std::isfinite(v)) sorted.push_back(v);
  ValueScale out;
  out.unit = unit;
  if (sorted.empty()) return out;
  std::sort(sorted.begin(), sorted.end());
  const double least = double(sorted.front()), most = double(sorted.back());
  if (!(most > 0)) return out;
  const double high = double(sorted[size_t(kBelowTop * double(sorted.size() - 1))]);
  // A picture that is nearly black all over is scaled by its brightest.
  const double wanted = high > 0 ? high : most;
  const std::vector<double> tops = steps_between(wanted * 0.999, wanted * 10);
  out.top = tops.empty() ? wanted : tops.front();
  out.has_more = most > out.top;
  out.levels = steps_between(std::max(least, most * 1e-3), most);
  // Values that differ by less than a part in a thousand count as even: noise alone would draw
  // lines.
  if (out.levels.size() < kFewestLevels && most - least > 1e-3 * most)
    out.levels = multiples_between(least, most);
  if (out.levels.size() > kMostLevels)
    out.levels.erase(out.levels.begin(), out.levels.end() - std::ptrdiff_t(kMostLevels));
  return out;
}

Image8 draw_values(std::span<const float> values, int width, const ValueScale& scale,
                   Color8 background, std::span<const uint32_t> region) {
  LUXEL_CHECK(width > 0 && values.size() % size_t(width) == 0);
  LUXEL_CHECK(region.empty() || region.size() == values.size());
  const int height = int(values.size() / size_t(width));
  Image8 out{width, height, 3, std::vector<uint8_t>(3 * values.size())};
  std::array<Color8, 256> table;
  for (size_t i = 0; i < table.size(); ++i) table[i] = false_color(double(i) / 255);
  const auto crosses = [&](size_t i, size_t j) {
    const auto a = band_of(double(values[i]), scale), b = band_of(double(values[j]), scale);
    return a && b && *a != *b && (region.empty() || region[i] == region[j]);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t i = size_t(y) * size_t(width) + size_t(x);
      if (!std::isfinite(values[i])) {
        set_pixel(out, x, y, background);
        continue;
      }
      const double t = std::clamp(double(values[i]) / scale.top, 0.0, 1.0);
      const bool line =
          (x + 1 < width && crosses(i, i + 1)) || (y + 1 < height && crosses(i, i + size_t(width)));
      set_pixel(out, x, y, line ? line_color(t) : table[size_t(t * 255 + 0.5)]);
    }
  return out;
}

void draw_label(Image8& picture, int centre_x, int centre_y, std::string_view text) {
  const int w = text_width(text, kTextScale), h = kGlyphHeight * kTextScale;
  const int x = centre_x - w / 2, y = centre_y - h / 2;
  fill(picture, x - 2, y - 1, x + w + 2, y + h, kPaper);
  draw_text(picture, x, y, kTextScale, kInk, text);
}

void label_isolines(Image8& picture, std::span<const float> values, const ValueScale& scale,
                    std::vector<std::array<int, 2>>& taken) {
  const int width = picture.width, height = picture.height;
  LUXEL_CHECK(values.size() == size_t(width) * size_t(height));
  for (size_t level = 0; level < scale.levels.size(); ++level) {
    const std::string text = text_of_value(scale.levels[level]);
    const int edge_x = text_width(text, kTextScale) / 2 + 3, edge_y = kGlyphHeight;
    std::array<int, 2> best{};
    double most = kApart;
    for (int y = edge_y; y < height - edge_y; ++y)
      for (int x = edge_x; x < width - edge_x; ++x) {
        const size_t i = size_t(y) * size_t(width) + size_t(x);
        const auto a = band_of(double(values[i]), scale), b = band_of(double(values[i + 1]), scale);
        const auto c = band_of(double(values[i + size_t(width)]), scale);
        const auto is_here = [&](std::optional<size_t> other) {
          return a && other && std::min(*a, *other) <= level && std::max(*a, *other) > level;
        };
        if (!is_here(b) && !is_here(c)) continue;
        double apart = 1e9;
        for (const auto& [tx, ty] : taken)
          apart = std::min(apart, std::hypot(double(tx - x), 2.0 * double(ty - y)));
        if (apart > most) most = apart, best = {x, y};
      }
    if (best[0] == 0) continue;
    draw_label(picture, best[0], best[1], text);
    taken.push_back(best);
  }
}

Image8 with_legend(const Image8& picture, const ValueScale& scale) {
  LUXEL_CHECK(picture.channels >= 3);
  // Low pictures get a band below, so that the numbers of the legend do not lie on each other.
  const int height = std::max(picture.height, 160);
  Image8 out{picture.width + kLegendWidth, height, 3, {}};
  out.data.assign(size_t(3) * size_t(out.width) * size_t(height), 255);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const uint8_t* p = picture.data.data() +
                         size_t(picture.channels) * (size_t(y) * size_t(picture.width) + size_t(x));
      set_pixel(out, x, y, {p[0], p[1], p[2]});
    }
  const int x0 = picture.width + kMargin, top = 3 * kMargin + kGlyphHeight;
  const int bottom = height - kMargin - kGlyphHeight;
  draw_text(out, x0, kMargin, kTextScale, kInk, scale.unit);
  for (int y = top; y < bottom; ++y) {
    const double t = double(bottom - 1 - y) / double(bottom - 1 - top);
    fill(out, x0, y, x0 + kBarWidth, y + 1, false_color(t));
  }
  const auto tick = [&](double value, const std::string& text) {
    const int y = bottom - 1 - int(value / scale.top * double(bottom - 1 - top) + 0.5);
    fill(out, x0 + kBarWidth, y, x0 + kBarWidth + 4, y + 1, kInk);
    draw_text(out, x0 + kBarWidth + 8, y - kGlyphHeight / 2, kTextScale, kInk, text);
    return y;
  };
  int last = tick(scale.top, text_of_value(scale.top) + (scale.has_more ? " +" : ""));
  const int ground = tick(0, "0");
  for (size_t k = scale.levels.size(); k-- > 0;) {
    const int y = bottom - 1 - int(scale.levels[k] / scale.top * double(bottom - 1 - top) + 0.5);
    if (scale.levels[k] >= scale.top || y - last < kGlyphHeight + 2 ||
        ground - y < kGlyphHeight + 2)
      continue;
    last = tick(scale.levels[k], text_of_value(scale.levels[k]));
  }
  return out;
}

}  // namespace luxel::image
