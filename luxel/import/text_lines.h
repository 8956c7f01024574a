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

/// The whole word as a number; a + may stand before it. One that is too small for its type is 0,
/// one that is too large is none.
template <class T = float>
std::optional<T> finite_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value = 0;
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

/// `usemtl "oak"` means oak.
inline std::string_view without_quotes(std::string_view name) {
  const bool quoted = name.size() > 1 && name.front() == '"' && name.back() == '"';
  return quoted ? name.substr(1, name.size() - 2) : name;
}

/// Takes the next line off the text.
inline std::string_view next_line(std::string_view& text) {
  const size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// A line of an .obj or .mtl file, and its number from 1 on.
struct ObjLine {
  std::string_view text;
  size_t number = 0;
  size_t lines_before = 0;  ///< read so far
  std::string joined;       ///< of lines that go on
};

/// Takes the next line off the text; false at its end. Lines end with \n, \r\n or \r. One that ends
/// with a backslash goes on in the next, but for a comment: that may end with the name of a folder.
inline bool next_obj_line(std::string_view& text, ObjLine& line) {
  const auto take = [&] {
    const size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view taken = text.substr(0, end);
    text.remove_prefix(std::min(end + (text.substr(end, 2) == "\r\n" ? 2 : 1), text.size()));
    ++line.lines_before;
    return taken;
  };
  if (line.lines_before == 0 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.empty()) return false;
  line.text = take();
  line.number = line.lines_before;
  const bool is_comment = trimmed(line.text).starts_with('#');
  if (is_comment || !trimmed(line.text).ends_with('\\')) return true;
  line.joined.clear();
  for (std::string_view part = line.text;; part = take()) {
    const bool goes_on = trimmed(part).ends_with('\\');
    line.joined.append(part.substr(0, goes_on ? part.find_last_of('\\') : part.size())).append(" ");
    if (!goes_on || text.empty()) break;
  }
  line.text = line.joined;
  return true;
}

}  // namespace luxel::import
