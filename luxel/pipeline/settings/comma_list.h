// Settings that are lists.
#pragma once

#include <string_view>
#include <vector>

namespace luxel::pipeline {

/// What stands between the commas of `text`: one more than there are commas, empty ones included.
std::vector<std::string_view> split_at_commas(std::string_view text);

}  // namespace luxel::pipeline
