#include "luxel/base/shown_text.h"

#include <algorithm>
#include <cstdint>

namespace luxel {
inline namespace base {
namespace {

/// File names may be this long, and are of use only whole.
constexpr size_t kLongestWord = 400;
/// Bytes that stay of a word that is cut, before and after the cut.
constexpr size_t kHead = 100, kTail = 20;

/// A character of a text, or a byte that belongs to none.
struct Character {
  uint32_t code = 0;
  size_t bytes = 1;
  bool is_utf8 = true;
};

/// The one that starts at `at` [Unicode 15, table 3-7: well-formed byte sequences].
Character character_at(std::string_view text, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(at);
  if (first < 0x80) return {first};
  const size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || bytes > text.size() - at) return {first, 1, false};
  uint32_t code = first & (0xffu >> (bytes + 1));
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(at + i) & 0xc0) != 0x80) return {first, 1, false};
    code = code << 6 | (byte(at + i) & 0x3f);
  }
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  if (code < kLeast[bytes] || is_surrogate || code > 0x10ffff) return {first, 1, false};
  return {code, bytes};
}

/// A terminal would obey it, or it would change the order of the text around it [Unicode UAX 9].
bool is_unseen(uint32_t code) {
  const auto is_within = [&](uint32_t first, uint32_t last) {
    return code >= first && code <= last;
  };
  return code < 0x20 || is_within(0x7f, 0x9f) || code == 0x61c || is_within(0x200e, 0x200f) ||
         is_within(0x2028, 0x202e) || is_within(0x2066, 0x2069);
}

/// The last digits of a number in base 16.
std::string hex(uint32_t number, int digits) {
  std::string out;
  for (int d = digits - 1; d >= 0; --d) out += "0123456789abcdef"[number >> (4 * d) & 15];
  return out;
}

std::string json_escape(uint32_t code) { return "\\u" + hex(code, 4); }

std::string escape(const Character& c) {
  if (!c.is_utf8) return "\\x" + hex(c.code, 2);
  for (const auto& [code, name] : {std::pair('\n', "\\n"), {'\r', "\\r"}, {'\t', "\\t"}})
    if (c.code == uint32_t(code)) return name;
  return c.code < 0x80 ? "\\x" + hex(c.code, 2) : json_escape(c.code);
}

/// The text with `put(character)` for each character that it gives a text for; most are plain.
template <class Put>
std::string replaced(std::string_view text, const Put& put) {
  const auto is_plain = [](char c) { return c >= 0x20 && c < 0x7f; };
  std::string out;
  out.reserve(text.size());
  for (size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    const size_t plain = size_t(std::ranges::find_if_not(rest, is_plain) - rest.begin());
    out.append(rest.substr(0, plain));
    at += plain;
    if (at == text.size()) break;
    const Character c = character_at(text, at);
    const std::string instead = put(c);
    instead.empty() ? out.append(text.substr(at, c.bytes)) : out.append(instead);
    at += c.bytes;
  }
  return out;
}

/// `at`, or the start of the character that it lies in.
size_t character_start(std::string_view text, size_t at) {
  while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) --at;
  return at;
}

/// Only what is shown is looked at: a panel asks for each of its frames.
void append_short(std::string_view word, std::string& out) {
  if (word.size() <= kLongestWord) {
    out += shown_text(word);
    return;
  }
  const size_t head = character_start(word, kHead);
  const size_t tail = character_start(word, word.size() - kTail);
  out += shown_text(word.substr(0, head)) + "[" + std::to_string(tail - head) + " bytes]" +
         shown_text(word.substr(tail));
}

}  // namespace

std::string shown_text(std::string_view text) {
  return replaced(text, [](const Character& c) {
    return c.is_utf8 && !is_unseen(c.code) ? std::string() : escape(c);
  });
}

std::string short_message(std::string_view text, size_t most_bytes) {
  std::string out;
  for (size_t at = 0; at < text.size() && out.size() <= most_bytes;) {
    const size_t end = std::min(text.find(' ', at), text.size());
    append_short(text.substr(at, end - at), out);
    if (end < text.size()) out += ' ';
    at = end + 1;
  }
  if (out.size() <= most_bytes) return out;
  const size_t end = character_start(out, most_bytes);
  return out.substr(0, end) + " [" + std::to_string(text.size()) + " bytes in all]";
}

std::string valid_utf8(std::string_view text) {
  return replaced(text,
                  [](const Character& c) { return std::string(c.is_utf8 ? "" : "\xef\xbf\xbd"); });
}

std::string shown_json(std::string text) {
  // Line breaks are those between values: in a string they are escapes already.
  return replaced(text, [](const Character& c) {
    return c.code != '\n' && is_unseen(c.code) ? json_escape(c.code) : std::string();
  });
}

}  // namespace base
}  // namespace luxel
