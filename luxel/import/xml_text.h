// Tags and attributes of XML text, found without a parser. For this room only.
#pragma once

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "luxel/import/readers.h"

namespace luxel::import {

inline constexpr std::string_view kXmlBlanks = " \t\r\n";

struct XmlTag {
  std::string_view text;  ///< from < to >
  std::string_view name;
  bool opens = false, closes = false;  ///< an empty element does both
  size_t at = 0;                       ///< where it starts in the file
  size_t end() const { return at + text.size(); }
};

/// The first tag from `at` on; none at the end of the file. Comments, CDATA and instructions are
/// skipped, but not what a DOCTYPE holds: no element may be missed.
inline std::optional<XmlTag> next_tag(std::string_view file, size_t at) {
  const auto after = [&](std::string_view mark, size_t from) {
    return std::min(file.find(mark, from), file.size() - mark.size()) + mark.size();
  };
  while ((at = file.find('<', at)) != file.npos) {
    const std::string_view rest = file.substr(at);
    if (rest.starts_with("<!--")) {
      at = after("-->", at + 4);
    } else if (rest.starts_with("<![CDATA[")) {
      at = after("]]>", at + 9);
    } else if (rest.starts_with("<?")) {
      at = after("?>", at + 2);
    } else if (rest.starts_with("<!")) {
      at += 2;
    } else {
      size_t end = 0;
      while ((end = rest.find_first_of("\"'>", end)) != rest.npos && rest[end] != '>')
        end = std::min(rest.find(rest[end], end + 1), rest.size() - 1) + 1;
      XmlTag tag;
      tag.text = rest.substr(0, std::min(end, rest.size() - 1) + 1);
      tag.at = at;
      const bool is_end = rest.starts_with("</");
      const size_t start = is_end ? 2 : 1;
      tag.name = tag.text.substr(std::min(start, tag.text.size()));
      tag.name = tag.name.substr(0, tag.name.find_first_of(" \t\r\n/>"));
      tag.opens = !is_end;
      tag.closes = is_end || tag.text.ends_with("/>");
      return tag;
    }
  }
  return std::nullopt;
}

/// The value of an attribute of the element's own tag; empty without one.
inline std::string_view attribute(std::string_view element, std::string_view name) {
  size_t at = std::min(element.find_first_of(" \t\r\n/>"), element.size());
  while ((at = element.find_first_not_of(kXmlBlanks, at)) != element.npos) {
    const size_t name_end = element.find_first_of(" \t\r\n=>", at);
    const size_t equals = element.find_first_not_of(kXmlBlanks, name_end);
    if (equals == element.npos || element[equals] != '=') return {};
    const size_t quote = element.find_first_not_of(kXmlBlanks, equals + 1);
    if (quote == element.npos || (element[quote] != '"' && element[quote] != '\'')) return {};
    const size_t end = element.find(element[quote], quote + 1);
    if (end == element.npos) return {};
    if (element.substr(at, name_end - at) == name)
      return element.substr(quote + 1, end - quote - 1);
    at = end + 1;
  }
  return {};
}

/// True: a parser would turn the value into something else, so names cannot be compared as they
/// stand.
inline bool needs_decoding(std::string_view value) {
  for (size_t at = 0; (at = value.find_first_of("&\t\r\n", at)) != value.npos; ++at)
    if (!value.substr(at).starts_with("&amp;")) return true;
  return false;
}

/// A whole number in an attribute; `otherwise` when the attribute is missing, none when it is
/// wrong.
inline std::optional<uint64_t> attribute_number(std::string_view element, std::string_view name,
                                                uint64_t otherwise) {
  const std::string_view word = attribute(element, name);
  if (word.empty()) return otherwise;
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  // 32 bits, as in Assimp, so that their products fit into 64.
  if (error != std::errc() || end != word.data() + word.size() || value > UINT32_MAX) return {};
  return value;
}

/// The name that a reference such as #name points at; empty for other files.
inline std::string_view name_referred_to(std::string_view reference) {
  return reference.starts_with('#') ? reference.substr(1) : std::string_view();
}

/// The number of the line, from 1 on, in which byte `at` of a text is.
inline size_t line_of(std::string_view text, size_t at) {
  return 1 + size_t(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
}

}  // namespace luxel::import
