// Settings that are lists.
#pragma once

#include <string_view>
#include <vector>

namespace luxel::pipeline {

/// The parts of `text` between its commas: one more than there are commas, empty ones included.
std::vector<std::string_view> split_at_commas(std::string_view text);

}  // namespace luxel::pipeline
