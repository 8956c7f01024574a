// A walk through an .fbx file before Assimp gets it: Assimp calls itself for blocks in blocks, and
// for models that its list of connections puts into models, and asks neither for depth nor circles.
// It makes room for as many numbers as an array states.
#include <charconv>
#include <cstring>
#include <map>

#include "luxel/import/nesting.h"
#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

/// One line of an .fbx file, `key: value, value, ...`; only the first values are kept.
struct FbxElement {
  static constexpr size_t kMostValues = 4;
  std::string_view key;
  std::vector<std::string_view> values;
  size_t at = 0;                  ///< its first byte in the file
  std::string_view all_values{};  ///< as they stand in a binary file
};

/// The file's models and the connections between them.
struct FbxModels {
  std::map<uint64_t, uint32_t> number{{0, 0}};  ///< of an id; id 0 is the scene
  std::vector<size_t> at{0};
  std::vector<std::pair<uint64_t, uint64_t>> pairs;  ///< ids: the model, and what it is put into
};

/// Reads what stands in a section; `id_of` reads an id.
template <class IdOf>
void note(std::string_view section, const FbxElement& element, const IdOf& id_of,
          FbxModels& models) {
  const auto& values = element.values;
  if (section == "Objects" && element.key == "Model" && !values.empty()) {
    if (models.number.try_emplace(id_of(values[0]), uint32_t(models.at.size())).second)
      models.at.push_back(element.at);
  }
  if (section != "Connections" || element.key != "C" || values.size() < 3) return;
  // OP ties a model to a property, such as the target of a light.
  if (values[0] == "PP" || (values[0] == "OP" && values.size() > 3 && !values[3].empty())) return;
  models.pairs.emplace_back(id_of(values[1]), id_of(values[2]));
}

/// `place` says where a byte is.
template <class Place>
Status check_models(const SourceFile& source, const FbxModels& models, const Place& place) {
  std::vector<std::vector<uint32_t>> parts(models.at.size());
  for (const auto& [child, parent] : models.pairs) {
    const auto of_child = models.number.find(child), of_parent = models.number.find(parent);
    if (of_child == models.number.end() || of_parent == models.number.end()) continue;
    if (of_child->second != 0) parts[of_parent->second].push_back(of_child->second);
  }
  const auto wrong = wrong_nesting(parts);
  if (!wrong) return {};
  if (wrong->part == 0)
    return fail(ErrorCode::bad_input, "{}: the scene {}", source.name, wrong->what);
  return fail(ErrorCode::bad_input, "{}, {}: the model there {}", source.name,
              place(models.at[wrong->part]), wrong->what);
}

/// Takes keys, values and brackets off a text .fbx file as Assimp does.
struct FbxWords {
  std::string_view text;
  size_t at = 0;
  bool is_key = false;  ///< of the word last taken

  /// Empty at the end of the file. Quotes stay on.
  std::string_view next() {
    is_key = false;
    skip_blanks();
    const size_t start = at;
    if (at == text.size()) return {};
    if (text[at] == '{' || text[at] == '}' || text[at] == ':') return text.substr(at++, 1);
    if (text[at] == '"') {
      at = std::min(text.find('"', at + 1), text.size() - 1) + 1;
      return text.substr(start, at - start);
    }
    at = std::min(text.find_first_of(" \t\r\n\f,;:{}\"", at), text.size());
    const std::string_view word = text.substr(start, at - start);
    const size_t colon = text.find_first_not_of(" \t\r\n\f", at);
    is_key = colon != text.npos && text[colon] == ':';
    if (is_key) at = colon + 1;
    return word;
  }

 private:
  void skip_blanks() {
    for (; at < text.size(); ++at) {
      if (text[at] == ';') at = std::min(text.find_first_of("\r\n\f", at), text.size() - 1);
      if (std::string_view(" \t\r\n\f,;").find(text[at]) == std::string_view::npos) return;
    }
  }
};

uint64_t id_in_text(std::string_view word) {
  uint64_t id = UINT64_MAX;
  std::from_chars(word.data(), word.data() + word.size(), id);
  return id;
}

Status check_text(const SourceFile& source) {
  std::string_view text = text_of(source.bytes);
  text = text.substr(0, text.find('\0'));
  const auto place = [&](size_t at) { return fmt::format("line {}", line_of(text, at)); };
  FbxWords words{text};
  FbxModels models;
  FbxElement element;
  std::string_view section;
  size_t depth = 0;
  const auto end_element = [&] {
    if (depth == 1) note(section, element, id_in_text, models);
    element = {};
  };
  for (std::string_view word; !(word = words.next()).empty();) {
    const size_t at = size_t(word.data() - text.data());
    if (words.is_key) {
      end_element();
      element = {word, {}, at};
    } else if (word == "{") {
      if (depth == 0) section = element.key;
      end_element();
      if (++depth > kDeepestNesting)
        return fail(ErrorCode::bad_input, "{}, {}: more than {} blocks are nested", source.name,
                    place(at), kDeepestNesting);
    } else if (word == "}") {
      end_element();
      depth -= depth > 0;
    } else if (element.values.size() < FbxElement::kMostValues) {
      element.values.push_back(without_quotes(word));
    }
  }
  return check_models(source, models, place);
}

/// Takes numbers and bytes off a binary .fbx file, little-endian.
struct FbxBytes {
  std::string_view file;
  size_t at = 0;
  size_t word = 4;  ///< bytes of an offset: 8 from version 7500 on

  /// None when less is left before `end`.
  std::optional<uint64_t> number(size_t bytes, size_t end) {
    if (at > end || end - at < bytes) return std::nullopt;
    uint64_t value = 0;
    std::memcpy(&value, file.data() + at, bytes);
    at += bytes;
    return value;
  }
};

/// The strings and 64-bit numbers at the start of an element's values.
std::vector<std::string_view> values_of(std::string_view bytes) {
  std::vector<std::string_view> values;
  while (bytes.size() > 4 && values.size() < FbxElement::kMostValues) {
    uint32_t length = 8;
    size_t start = 1;
    if (bytes.front() == 'S') {
      std::memcpy(&length, bytes.data() + 1, 4);
      start = 5;
    } else if (bytes.front() != 'L') {
      break;
    }
    if (bytes.size() < start + length) break;
    values.push_back(bytes.substr(start, length));
    bytes.remove_prefix(start + length);
  }
  return values;
}

uint64_t id_in_bytes(std::string_view bytes) {
  uint64_t id = UINT64_MAX;
  if (bytes.size() == 8) std::memcpy(&id, bytes.data(), 8);
  return id;
}

/// An element's head: where it ends, its key and its values. None where Assimp would give up, or
/// when the element is the zero that ends a list.
std::optional<FbxElement> next_block(FbxBytes& bytes, size_t limit, uint64_t& end) {
  FbxElement element{{}, {}, bytes.at};
  const auto its_end = bytes.number(bytes.word, limit);
  end = its_end.value_or(0);
  if (end == 0) return std::nullopt;
  const auto values = bytes.number(bytes.word, limit), length = bytes.number(bytes.word, limit),
             name = bytes.number(1, limit);
  if (!values || !length || !name || end > limit || *name > limit - bytes.at) return std::nullopt;
  element.key = bytes.file.substr(bytes.at, *name);
  bytes.at += *name;
  if (*length > limit - bytes.at) return std::nullopt;
  if (element.key == "Model" || element.key == "C")
    element.values = values_of(bytes.file.substr(bytes.at, *length));
  element.all_values = bytes.file.substr(bytes.at, *length);
  bytes.at += *length;
  return element;
}

/// Bytes of a number of a binary file, by its letter; 0 for what is none.
uint64_t bytes_per_number(char type) {
  switch (type) {
    case 'C':
    case 'c':
      return 1;
    case 'Y':
      return 2;
    case 'I':
    case 'F':
    case 'i':
    case 'f':
      return 4;
    case 'L':
    case 'D':
    case 'l':
    case 'd':
      return 8;
    default:
      return 0;
  }
}

/// Assimp makes room for all numbers that an array states before it looks for them. An array:
/// small letter, count, 1 if it is compressed, bytes, and these.
Status check_arrays(const SourceFile& source, const FbxElement& element) {
  constexpr uint64_t kMostExpansion = 1032;  // by zlib: 258 bytes for two bits
  constexpr size_t kHead = 1 + 3 * 4;
  std::string_view left = element.all_values;
  while (!left.empty()) {
    const char type = left.front();
    const uint64_t size = bytes_per_number(type);
    size_t length = 1 + size;
    if (size == 0 || type >= 'a') {
      const size_t head = size == 0 ? 1 + 4 : kHead;
      if (left.size() < head) return {};
      uint32_t numbers[3] = {};  // of a text or of raw bytes only the last: their length
      std::memcpy(size == 0 ? &numbers[2] : numbers, left.data() + 1, head - 1);
      const auto [count, is_compressed, bytes] = numbers;
      const uint64_t needed = count * size;
      if (needed > UINT32_MAX || needed > bytes * (is_compressed ? kMostExpansion : 1))
        return fail(ErrorCode::bad_input,
                    "{}, byte {}: {} states {} numbers, more than its {} bytes can hold",
                    source.name, element.at, element.key, count, bytes);
      LUXEL_TRY_STATUS(source.memory.take(needed, "the numbers of " + source.name));
      length = head + bytes;
    }
    if (length > left.size()) return {};
    left.remove_prefix(length);
  }
  return {};
}

constexpr std::string_view kFbxMagic = "Kaydara FBX Binary";

/// Other damages are left to Assimp, which checks every other size.
Status check_binary(const SourceFile& source) {
  FbxBytes bytes{text_of(source.bytes), 23};
  const auto version = bytes.number(4, source.bytes.size());
  if (!version) return {};
  if (*version >= 7500) bytes.word = 8;
  const size_t sentinel = 3 * bytes.word + 1;  // the zeros that end a block
  const auto place = [](size_t at) { return fmt::format("byte {}", at); };
  FbxModels models;
  std::string_view section;
  std::vector<uint64_t> ends;  // of the open blocks, before their sentinels
  while (!ends.empty() || bytes.at < source.bytes.size()) {
    if (!ends.empty() && bytes.at >= ends.back()) {
      if (bytes.at != ends.back()) return {};
      bytes.at += sentinel;
      ends.pop_back();
      continue;
    }
    uint64_t end = 0;
    const size_t before = bytes.at;
    const auto element = next_block(bytes, ends.empty() ? source.bytes.size() : ends.back(), end);
    // Assimp steps over zeros in a block.
    if (!element && end == 0 && !ends.empty() && bytes.at > before) continue;
    if (!element) break;
    LUXEL_TRY_STATUS(check_arrays(source, *element));
    if (ends.size() == 1) note(section, *element, id_in_bytes, models);
    if (ends.empty()) section = element->key;
    if (bytes.at == end) continue;
    if (bytes.at > end || end - bytes.at < sentinel) return {};
    ends.push_back(end - sentinel);
    if (ends.size() > kDeepestNesting)
      return fail(ErrorCode::bad_input, "{}, {}: more than {} blocks are nested", source.name,
                  place(before), kDeepestNesting);
  }
  return check_models(source, models, place);
}

}  // namespace

Status check_fbx(const SourceFile& source) {
  return text_of(source.bytes).starts_with(kFbxMagic) ? check_binary(source) : check_text(source);
}

}  // namespace luxel::import
