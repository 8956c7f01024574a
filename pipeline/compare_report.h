// report.html of `luxel compare --report`.
#pragma once

#include <string>

#include "pipeline/compare.h"
#include "pipeline/picture.h"

namespace luxel::pipeline {

/// What compare() had in its hands.
struct CompareImages {
  std::string name_a, name_b;
  const Picture &a, &b;
  const image::Mask& covered;
  const image::Image8 &shown_a, &shown_b;
  const image::Image& flip;
  /// preview.png of two bakes; both or none.
  std::vector<image::Image8> previews;
};

std::string compare_report(const Compared& compared, const CompareImages& images);

}  // namespace luxel::pipeline
