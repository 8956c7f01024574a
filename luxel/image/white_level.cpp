#include "luxel/image/white_level.h"

#include <algorithm>
#include <vector>

namespace luxel::image {
namespace {

/// A thousandth of the values clips at most, as few as the texels beside a light are.
constexpr double kPercentile = 0.999;

float white_level_of(std::vector<float> values) {
  if (values.empty()) return 1;
  const size_t rank = size_t(double(values.size() - 1) * kPercentile);
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  if (values[rank] > 0) return values[rank];
  const float largest = *std::max_element(values.begin(), values.end());
  return largest > 0 ? largest : 1;
}

}  // namespace

float white_level(std::span<const Rgb> values) {
  std::vector<float> largest;
  for (const Rgb& value : values) largest.push_back(max_component(value));
  return white_level_of(std::move(largest));
}

float white_level(std::span<const Image> images) {
  std::vector<float> largest;
  for (const Image& image : images)
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (image.at(x, y)[3] > 0) largest.push_back(max_component(image.rgb(x, y)));
  return white_level_of(std::move(largest));
}

}  // namespace luxel::image
