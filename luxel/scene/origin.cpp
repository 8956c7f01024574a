#include "luxel/scene/origin.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace luxel::scene {

double short_number(float value, double origin) {
  double out = double(value) + origin;
  if (origin == 0) {
    const std::string digits = fmt::format("{}", value);
    std::from_chars(digits.data(), digits.data() + digits.size(), out);
    return out;
  }
  constexpr int kMostDecimals = 12;
  for (int d = 0; d <= kMostDecimals; ++d) {
    const std::string digits = fmt::format("{:.{}f}", double(value) + origin, d);
    double rounded = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
    if (float(rounded - origin) == value) return rounded;
  }
  return out;
}

}  // namespace luxel::scene
