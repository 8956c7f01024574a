#include "luxel/pipeline/render/exposure.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "luxel/display/tone_map.h"

namespace luxel::pipeline {
namespace {

constexpr double kMostStops = 64;

std::optional<double> number_in(std::string_view text, double low, double high) {
  if (text.starts_with('+')) text.remove_prefix(1);  // photographers write +1
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  if (!whole || !(value >= low && value <= high)) return std::nullopt;
  return value;
}

}  // namespace

Result<Exposure> parse_exposure(std::string_view text) {
  constexpr std::string_view kAuto = "auto";
  if (text == kAuto) return Exposure{};
  if (text.starts_with("auto:")) {
    if (const auto percentile = number_in(text.substr(kAuto.size() + 1), 0, 100))
      return Exposure{.percentile = *percentile};
  } else if (const auto stops = number_in(text, -kMostStops, kMostStops)) {
    return Exposure{.automatic = false, .stops = *stops};
  }
  return fail(ErrorCode::bad_setting,
              "--exposure '{}' is neither auto, nor auto:PERCENTILE with 0 to 100, nor a number of "
              "stops from -{} to {}, as in --exposure 1.5",
              text, kMostStops, kMostStops);
}

float exposure_factor(const Exposure& exposure, const image::Image& radiance) {
  if (!exposure.automatic) return display::exposure_of_stops(exposure.stops);
  return exposure.percentile ? display::auto_exposure(radiance, *exposure.percentile)
                             : display::readable_exposure(radiance);
}

}  // namespace luxel::pipeline
