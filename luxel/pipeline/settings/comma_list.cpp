#include "luxel/pipeline/settings/comma_list.h"

namespace luxel::pipeline {

std::vector<std::string_view> split_at_commas(std::string_view text) {
  std::vector<std::string_view> out;
  for (size_t comma; (comma = text.find(',')) != std::string_view::npos;) {
    out.push_back(text.substr(0, comma));
    text.remove_prefix(comma + 1);
  }
  out.push_back(text);
  return out;
}

}  // namespace luxel::pipeline
