// A walk through a .ply file before Assimp gets it: header, then every element, text or binary.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "luxel/import/readers.h"

namespace luxel::import {
namespace {

enum class Kind { none, i8, u8, i16, u16, i32, u32, f32, f64 };

Kind kind_of(std::string_view name) {
  if (name == "char" || name == "int8") return Kind::i8;
  if (name == "uchar" || name == "uint8") return Kind::u8;
  if (name == "short" || name == "int16") return Kind::i16;
  if (name == "ushort" || name == "uint16") return Kind::u16;
  if (name == "int" || name == "int32") return Kind::i32;
  if (name == "uint" || name == "uint32") return Kind::u32;
  if (name == "float" || name == "float32") return Kind::f32;
  if (name == "double" || name == "float64") return Kind::f64;
  return Kind::none;
}

size_t size_of(Kind kind) {
  constexpr size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[size_t(kind)];
}

struct Property {
  Kind kind = Kind::none;
  Kind list_count = Kind::none;  ///< of a list; none for a single number
  std::string name;
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  enum class Format { none, ascii, little, big } format = Format::none;
  std::vector<Element> elements;
  bool is_open = false;  ///< properties may follow the last line
  std::string_view body;
};

template <class T>
T reversed_if(bool reverse, const char* p) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, p, sizeof(T));
  if (reverse) std::reverse(bytes, bytes + sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

double number_at(const char* p, Kind kind, bool reverse) {
  switch (kind) {
    case Kind::i8:
      return double(reversed_if<int8_t>(false, p));
    case Kind::u8:
      return double(reversed_if<uint8_t>(false, p));
    case Kind::i16:
      return double(reversed_if<int16_t>(reverse, p));
    case Kind::u16:
      return double(reversed_if<uint16_t>(reverse, p));
    case Kind::i32:
      return double(reversed_if<int32_t>(reverse, p));
    case Kind::u32:
      return double(reversed_if<uint32_t>(reverse, p));
    case Kind::f32:
      return double(reversed_if<float>(reverse, p));
    case Kind::f64:
      return reversed_if<double>(reverse, p);
    case Kind::none:
      break;
  }
  return NAN;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t at = 0; (at = line.find_first_not_of(" \t\r", at)) != line.npos;) {
    const size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Assimp ends a line at more than its end.
bool would_be_broken(std::string_view line) {
  return line.find_first_of(std::string_view("\r\f\0", 3)) != line.npos;
}

/// One line of the header; false when it makes no sense. Assimp ends an element at the first line
/// that is no property, and would take the properties after it for nothing.
bool read_header_line(const std::vector<std::string_view>& words, PlyHeader& header) {
  const bool was_open = std::exchange(header.is_open, false);
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return true;
  header.is_open = words[0] == "element" || (was_open && words[0] == "property");
  if (words[0] == "format" && words.size() >= 2) {
    if (header.format != PlyHeader::Format::none || !header.elements.empty()) return false;
    header.format = words[1] == "ascii"                  ? PlyHeader::Format::ascii
                    : words[1] == "binary_little_endian" ? PlyHeader::Format::little
                                                         : PlyHeader::Format::big;
    return words[1] == "ascii" || words[1].starts_with("binary_");
  }
  if (words[0] == "element" && words.size() == 3) {
    Element element{std::string(words[1]), 0, {}};
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
    // Assimp makes room for the first vertices, and puts the second there, too.
    for (const Element& other : header.elements)
      if (other.name == element.name) return false;
    header.elements.push_back(std::move(element));
    return error == std::errc() && stop == end;
  }
  if (words[0] != "property" || !was_open) return false;
  Property property;
  if (words.size() == 5 && words[1] == "list")
    property = {kind_of(words[3]), kind_of(words[2]), std::string(words[4])};
  else if (words.size() == 3)
    property = {kind_of(words[1]), Kind::none, std::string(words[2])};
  header.elements.back().properties.push_back(property);
  return property.kind != Kind::none && (words.size() == 3 || property.list_count != Kind::none);
}

Result<PlyHeader> read_header(const SourceFile& source) {
  std::string_view text(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
  PlyHeader header;
  for (size_t number = 1;; ++number) {
    const size_t end = text.find('\n');
    if (end == text.npos)
      return fail(ErrorCode::bad_input, "{}: its header ends early", source.name);
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (would_be_broken(line))
      return fail(ErrorCode::bad_input, "{}, line {}: a line break is broken", source.name, number);
    const auto words = words_of(line);
    text.remove_prefix(end + 1);
    if (number == 1) {
      if (words.size() == 1 && words[0] == "ply") continue;
      return fail(ErrorCode::bad_input, "{}: it is not a .ply file: its first line is not 'ply'",
                  source.name);
    }
    if (!words.empty() && words[0] == "end_header") break;
    if (!read_header_line(words, header))
      return fail(ErrorCode::bad_input, "{}, line {}: this line of the header makes no sense",
                  source.name, number);
  }
  if (header.format == PlyHeader::Format::none)
    return fail(ErrorCode::bad_input, "{}: its header states no format", source.name);
  header.body = text;
  return header;
}

/// A whole word as a number. Assimp reads whole numbers up to what is no digit, in 32 bits, and
/// would take the rest of 0.05 for the next number.
bool is_number(std::string_view word, Kind kind, double& value) {
  const bool is_signed = kind != Kind::u8 && kind != Kind::u16 && kind != Kind::u32;
  if (is_signed && word.starts_with('+')) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  if (kind == Kind::f32 || kind == Kind::f64) {
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    return error != std::errc::invalid_argument && stop == end;
  }
  int64_t whole = 0;
  const auto [stop, error] = std::from_chars(word.data(), end, whole);
  value = double(whole);
  return error == std::errc() && stop == end && whole >= (is_signed ? INT32_MIN : 0) &&
         whole <= (is_signed ? INT32_MAX : int64_t(UINT32_MAX));
}

/// Hands out the numbers of the body one by one.
struct Reader {
  PlyHeader::Format format;
  std::string_view rest;
  std::string_view line = {};  ///< what is left of it; text only

  /// To the next line of a text, since Assimp reads each element from a line of its own. False
  /// where there is none, or where Assimp would break it.
  bool begin_element() {
    if (format != PlyHeader::Format::ascii) return true;
    if (rest.empty()) return false;
    const size_t length = std::min(rest.find('\n'), rest.size());
    line = rest.substr(0, length);
    rest.remove_prefix(std::min(length + 1, rest.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return !would_be_broken(line);
  }

  /// False at the end of the file, or at a word that is no number.
  bool next(Kind kind, double& value) {
    if (format != PlyHeader::Format::ascii) {
      if (rest.size() < size_of(kind)) return false;
      value = number_at(rest.data(), kind, format == PlyHeader::Format::big);
      rest.remove_prefix(size_of(kind));
      return true;
    }
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const size_t length = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view word = line.substr(0, length);
    line.remove_prefix(length);
    return is_number(word, kind, value);
  }
};

/// One number or list. Errors: not finite, no vertex of that index.
/// `where` is a function: a sentence is made only for the number that is wrong.
template <class Where>
Status check_property(const Property& property, Reader& reader, uint64_t vertices,
                      const Where& where) {
  double count = 1, value = 0;
  const bool is_list = property.list_count != Kind::none;
  if (is_list && (!reader.next(property.list_count, count) || count < 0))
    return fail(ErrorCode::bad_input, "{}: the file ends early, or a number is broken", where());
  const bool is_index = property.name == "vertex_indices" || property.name == "vertex_index";
  if (is_list && is_index && count == 0)  // Assimp crashes on some
    return fail(ErrorCode::bad_input, "{}: it has no corner", where());
  for (double i = 0; i < count; ++i) {
    if (!reader.next(property.kind, value))
      return fail(ErrorCode::bad_input, "{}: the file ends early, or a number is broken", where());
    if (!std::isfinite(value))
      return fail(ErrorCode::bad_input, "{}: {} is {}, not a finite number", where(), property.name,
                  value);
    if (is_index && (value < 0 || value >= double(vertices)))
      return fail(ErrorCode::bad_input,
                  "{}: vertex index {} is out of range, there are {} vertices", where(), value,
                  vertices);
  }
  return {};
}

}  // namespace

Status check_ply(const SourceFile& source) {
  LUXEL_TRY(const PlyHeader header, read_header(source));
  uint64_t vertices = 0;
  for (const Element& element : header.elements)
    if (element.name == "vertex") vertices = element.count;
  Reader reader{header.format, header.body};
  for (const Element& element : header.elements) {
    // Nothing to read is nothing that a wrong count would run into, but Assimp counts it one by
    // one.
    if (element.properties.empty() && element.count > header.body.size())
      return fail(ErrorCode::bad_input, "{}: there are {} of the element {}, and no properties",
                  source.name, element.count, element.name);
    for (uint64_t i = 0; i < element.count; ++i) {
      const auto where = [&] { return fmt::format("{}: {} {}", source.name, element.name, i); };
      if (!reader.begin_element())
        return fail(ErrorCode::bad_input, "{}: the file ends early, or a line break is broken",
                    where());
      for (const Property& property : element.properties)
        LUXEL_TRY_STATUS(check_property(property, reader, vertices, where));
    }
  }
  return {};
}

}  // namespace luxel::import
