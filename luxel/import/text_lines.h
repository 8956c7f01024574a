// Words and lines of text files. For this room only.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace luxel::import {

inline constexpr std::string_view kBlank = " \t\r";

/// Takes the next word off the line; empty at its end.
inline std::string_view next_word(std::string_view& line) {
  const size_t start = std::min(line.find_first_not_of(kBlank), line.size());
  const size_t end = std::min(line.find_first_of(kBlank, start), line.size());
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

/// The letters A to Z made small, whatever the language of the machine.
inline std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return text;
}

/// The whole word as a number; a + may stand before it. One that is too small for a float is 0, one
/// that is too large is none.
inline std::optional<float> finite_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool too_small = error == std::errc::result_out_of_range &&
                         (word.find("e-") != word.npos || word.find("E-") != word.npos);
  if ((error != std::errc() && !too_small) || end != word.data() + word.size() ||
      !std::isfinite(value))
    return std::nullopt;
  return value;
}

inline std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The rest of a line without the blanks around it; names may hold blanks inside.
inline std::string_view trimmed(std::string_view rest) {
  const size_t start = std::min(rest.find_first_not_of(kBlank), rest.size());
  return rest.substr(start, std::max(rest.find_last_not_of(kBlank) + 1, start) - start);
}

/// Takes the next line off the text.
inline std::string_view next_line(std::string_view& text) {
  const size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace luxel::import
