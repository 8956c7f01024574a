// Exposure of a picture, in the terms in which people ask for it.
#pragma once

#include <optional>
#include <string_view>

#include "luxel/base/result.h"
#include "luxel/image/image.h"

namespace luxel::pipeline {

struct Exposure {
  bool automatic = true;
  /// automatic: this percentile of luminance is shown at 0.6; none: display::readable_exposure().
  std::optional<double> percentile = {};
  double stops = 0;  ///< otherwise: light is multiplied by 2^stops
};

/// "auto", "auto:95" or a number of stops, as in --exposure.
Result<Exposure> parse_exposure(std::string_view text);

/// The factor for this picture.
float exposure_factor(const Exposure& exposure, const image::Image& radiance);

}  // namespace luxel::pipeline
