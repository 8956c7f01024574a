#include "luxel/pipeline/settings/option_rows.h"

#include "luxel/base/shown_text.h"

#include <algorithm>

namespace luxel::pipeline {

std::string text_of(const Range& range) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  return low && high ? fmt::format("{} to {}", range.low, range.high)
         : low       ? fmt::format(">= {}", range.low)
         : high      ? fmt::format("<= {}", range.high)
                     : std::string();
}

Status out_of_range(std::string_view flag, const std::string& value, const Range& range) {
  const std::string wrong = !range.wrong.empty()        ? range.wrong
                            : std::isfinite(range.high) ? "is outside " + text_of(range)
                                                        : fmt::format("is below {}", range.low);
  return fail(ErrorCode::bad_setting, "{} {} {}{}{}", flag, value, wrong,
              range.advice.empty() ? "" : "; ", range.advice);
}

Failure not_used(std::string_view user, std::string_view flag, std::string_view users,
                 std::string_view advice) {
  return fail(ErrorCode::bad_setting, "{} does not use {}; leave {} out (it is for {}){}{}", user,
              flag, flag, users, advice.empty() ? "" : "; ", advice);
}

std::string key_of(std::string_view flag) {
  flag.remove_prefix(flag.starts_with("--no-") ? 5 : 2);
  std::string key(flag);
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

std::string option_text(const nlohmann::json& json) {
  if (json.is_string()) return json.get<std::string>();
  if (!json.is_array()) return json_text(json);
  std::string out;
  for (const nlohmann::json& one : json) out += (out.empty() ? "" : ",") + option_text(one);
  return out;
}

bool is_number(std::string_view text) {
  double ignored = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ignored);
  return end == text.data() + text.size() && error != std::errc::invalid_argument;
}

Status not_a_number(std::string_view flag, std::string_view text) {
  return fail(ErrorCode::bad_setting, "{} '{}' is not a number", flag, text);
}

Status unknown_name(std::string_view flag, std::string_view name, std::string_view names) {
  return fail(ErrorCode::bad_setting, "{} {} is not known; choose from: {}", flag, name, names);
}

}  // namespace luxel::pipeline
