// Words and lines of text files. For this room only.
#pragma once

#include <algorithm>
#include <cstddef>
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
