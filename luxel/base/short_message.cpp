#include "luxel/base/short_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace luxel {
inline namespace base {
namespace {

/// File names may be this long, and are of use only whole.
constexpr size_t kLongestWord = 400;
/// Bytes that stay of a word that is cut, before and after the cut.
constexpr size_t kHead = 100, kTail = 20;

/// `at`, or the start of the character that it lies in.
size_t character_start(std::string_view text, size_t at) {
  while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) --at;
  return at;
}

/// A terminal would obey it.
bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
}

void append_short(std::string_view word, std::string& out) {
  if (word.size() <= kLongestWord) {
    out += word;
    return;
  }
  const size_t head = character_start(word, kHead);
  const size_t tail = character_start(word, word.size() - kTail);
  out += fmt::format("{}[{} bytes]{}", word.substr(0, head), tail - head, word.substr(tail));
}

}  // namespace

std::string short_message(const std::string& given, size_t most_bytes) {
  std::string text = given, out;
  std::ranges::replace_if(text, is_control, '?');
  for (size_t at = 0; at < text.size() && out.size() <= most_bytes;) {
    const size_t end = std::min(text.find_first_of(" \n", at), text.size());
    append_short(std::string_view(text).substr(at, end - at), out);
    if (end < text.size()) out += text[end];
    at = end + 1;
  }
  if (out.size() <= most_bytes) return out;
  const size_t end = character_start(out, most_bytes);
  return out.substr(0, end) + fmt::format(" [{} bytes in all]", text.size());
}

}  // namespace base
}  // namespace luxel
