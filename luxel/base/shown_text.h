// Text that a file or a user gave, as people may see it: in messages, tables and panels. A terminal
// obeys control characters, a name in Latin-1 is no UTF-8, and either may be of any length.
#pragma once

#include <string>
#include <string_view>

namespace luxel {
inline namespace base {

/// One line of UTF-8 that moves no cursor and turns no text around: line breaks, tabs and other
/// control characters (\n, \x1b), marks of direction and separators of lines (\u202e), and bytes
/// that are no UTF-8 (\xfc) stand there as escapes. Everything else stays, backslashes too.
std::string shown_text(std::string_view text);

/// shown_text() with the middle of each word over 400 bytes, and all after `most_bytes`, taken out;
/// it says how many bytes are missing. Characters stay whole.
std::string short_message(std::string_view text, size_t most_bytes = 4000);

/// The text with U+FFFD, the replacement character, for each byte that is no UTF-8.
std::string valid_utf8(std::string_view text);

/// JSON that has been written, with an escape (\u202e) for each character for which shown_text()
/// has one: it means what it meant.
std::string shown_json(std::string text);

/// Any of nlohmann's kinds of JSON as text: the one way to write it, because dump() throws where a
/// string, such as a path, is no UTF-8. U+FFFD stands for what is not. `indent` -1: on one line.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
  return shown_json(json.dump(indent, ' ', false, Json::error_handler_t::replace));
}

}  // namespace base
}  // namespace luxel
