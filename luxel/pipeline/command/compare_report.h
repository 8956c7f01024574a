// report.html of `luxel compare --report`.
#pragma once

#include <string>

#include "luxel/pipeline/command/compare.h"

namespace luxel::pipeline {

/// `previews`: preview.png of two bakes, both or none.
std::string compare_report(const Picture& a, const Picture& b, const Measured& measured,
                           const std::vector<image::Image8>& previews);

}  // namespace luxel::pipeline
