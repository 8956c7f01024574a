// The header of a .ply file: its format, elements and their properties.
#include <charconv>

#include "luxel/import/ply.h"

namespace luxel::import {
namespace {

PlyType type_of(std::string_view name) {
  if (name == "char" || name == "int8") return PlyType::i8;
  if (name == "uchar" || name == "uint8") return PlyType::u8;
  if (name == "short" || name == "int16") return PlyType::i16;
  if (name == "ushort" || name == "uint16") return PlyType::u16;
  if (name == "int" || name == "int32") return PlyType::i32;
  if (name == "uint" || name == "uint32") return PlyType::u32;
  if (name == "float" || name == "float32") return PlyType::f32;
  if (name == "double" || name == "float64") return PlyType::f64;
  return PlyType::none;
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\f\v";
  std::vector<std::string_view> words;
  for (size_t at = 0; (at = line.find_first_not_of(kBlanks, at)) != line.npos;) {
    const size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// From the first of `words` to the end of the line: a file's name may have blanks.
std::string text_from(std::string_view word, std::string_view line) {
  std::string_view text = line.substr(size_t(word.data() - line.data()));
  text.remove_suffix(text.size() - text.find_last_not_of(" \t\r") - 1);
  return std::string(text);
}

/// `element NAME COUNT`; false when it is not that, or the name was there before.
bool read_element(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() != 3) return false;
  for (const PlyElement& other : header.elements)
    if (other.name == words[1]) return false;
  PlyElement& element = header.elements.emplace_back();
  element.name = words[1];
  const char* const end = words[2].data() + words[2].size();
  const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
  return error == std::errc() && stop == end;
}

/// `property TYPE NAME` or `property list TYPE TYPE NAME`, after an element.
bool read_property(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (header.elements.empty()) return false;
  PlyProperty property;
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (is_list)
    property = {type_of(words[3]), type_of(words[2]), std::string(words[4])};
  else if (words.size() == 3)
    property = {type_of(words[1]), PlyType::none, std::string(words[2])};
  header.elements.back().properties.push_back(property);
  return property.type != PlyType::none && is_list == property.is_list();
}

/// `format ascii 1.0` or another, once.
bool read_format(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() < 2 || header.format != PlyHeader::Format::none) return false;
  if (words[1] == "ascii") header.format = PlyHeader::Format::ascii;
  if (words[1] == "binary_little_endian") header.format = PlyHeader::Format::little;
  if (words[1] == "binary_big_endian") header.format = PlyHeader::Format::big;
  return header.format != PlyHeader::Format::none;
}

/// One line of the header; false when it makes no sense.
bool read_line(std::string_view line, const std::vector<std::string_view>& words,
               PlyHeader& header) {
  if (words.empty() || words[0] == "obj_info") return true;
  if (words[0] == "comment") {
    if (words.size() > 2 && words[1] == "TextureFile")
      header.texture_file = text_from(words[2], line);
    return true;
  }
  if (words[0] == "format") return read_format(words, header);
  if (words[0] == "element") return read_element(words, header);
  return words[0] == "property" && read_property(words, header);
}

}  // namespace

Result<PlyHeader> read_ply_header(const SourceFile& source) {
  std::string_view text(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
  PlyHeader header;
  for (size_t number = 1;; ++number) {
    const size_t end = text.find('\n');
    if (end == text.npos)
      return fail(ErrorCode::bad_input, "{}: its header ends early", source.name);
    const std::string_view line = text.substr(0, end);
    const auto words = words_of(line);
    text.remove_prefix(end + 1);
    if (number == 1) {
      if (words.size() == 1 && words[0] == "ply") continue;
      return fail(ErrorCode::bad_input, "{}: it is not a .ply file: its first line is not 'ply'",
                  source.name);
    }
    if (!words.empty() && words[0] == "end_header") break;
    if (!read_line(line, words, header))
      return fail(ErrorCode::bad_input, "{}, line {}: cannot understand this line of the header",
                  source.name, number);
  }
  if (header.format == PlyHeader::Format::none)
    return fail(ErrorCode::bad_input, "{}: its header states no format", source.name);
  header.body = text;
  return header;
}

}  // namespace luxel::import
