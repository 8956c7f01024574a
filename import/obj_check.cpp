// A look over an .obj file before Assimp gets it.
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/file.h"
#include "import/readers.h"

namespace luxel::import {
namespace {

constexpr std::string_view kBlank = " \t\r";

/// Takes the next word off the line; empty at its end.
std::string_view next_word(std::string_view& line) {
  const size_t start = std::min(line.find_first_not_of(kBlank), line.size());
  const size_t end = std::min(line.find_first_of(kBlank, start), line.size());
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

/// How many of each the file has so far; faces may only refer back or, in the files of some
/// exporters, ahead: indices are judged at the end.
struct Counts {
  int64_t v = 0, vt = 0, vn = 0;
};

struct Index {
  int64_t value = 0;  ///< from 1 on; 0 or less is out of range
  size_t line = 0;
};

struct ObjScan {
  Counts counts;
  Index largest[3];
  bool has_faces = false;
  std::set<std::string> with_color;
};

/// Every number of a v, vt or vn line must be one, and finite.
Status check_numbers(std::string_view rest, const std::string& where) {
  for (std::string_view word; !(word = next_word(rest)).empty();) {
    if (word.front() == '#') break;
    if (word.front() == '+') word.remove_prefix(1);
    float value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool too_small = error == std::errc::result_out_of_range &&
                           word.find("e-") != word.npos;  // underflow is a zero
    if ((error != std::errc() && !too_small) || end != word.data() + word.size() ||
        !std::isfinite(value))
      return fail(ErrorCode::bad_input, "{}: '{}' is not a finite number", where, word);
  }
  return {};
}

/// The corners v, v/vt, v//vn, v/vt/vn of an f line.
Status check_corners(std::string_view rest, ObjScan& scan, size_t line, const std::string& where) {
  const int64_t counts[3] = {scan.counts.v, scan.counts.vt, scan.counts.vn};
  for (std::string_view corner; !(corner = next_word(rest)).empty();) {
    if (corner.front() == '#') break;
    for (size_t k = 0; k < 3 && !corner.empty(); ++k) {
      const size_t slash = std::min(corner.find('/'), corner.size());
      const std::string_view word = corner.substr(0, slash);
      corner.remove_prefix(std::min(slash + 1, corner.size()));
      if (word.empty() && k > 0) continue;
      int64_t value = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size())
        return fail(ErrorCode::bad_input, "{}: '{}' is not a vertex index", where, word);
      if (value < 0) value += counts[k] + 1;  // -1 is the last one so far
      if (value < 1)
        return fail(ErrorCode::bad_input, "{}: index {} is out of range; {} come before", where,
                    word, counts[k]);
      if (value > scan.largest[k].value) scan.largest[k] = {value, line};
    }
  }
  return {};
}

std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The rest of a line without the blanks around it; names may hold blanks inside.
std::string_view trimmed(std::string_view rest) {
  const size_t start = std::min(rest.find_first_not_of(kBlank), rest.size());
  return rest.substr(start, std::max(rest.find_last_not_of(kBlank) + 1, start) - start);
}

/// Takes the next line off the text.
std::string_view next_line(std::string_view& text) {
  const size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// The materials of an .mtl that state Kd.
void read_library(std::string_view rest, const SourceFile& source, ObjScan& scan,
                  std::vector<std::string>& warnings) {
  const std::string_view name = trimmed(rest);
  if (name.empty()) return;
  const auto bytes = read_file(source.path.parent_path() / std::filesystem::path(name));
  if (!bytes) {
    warnings.push_back(
        fmt::format("{}: its material file {} is missing; a white that reflects 0.8 is used",
                    source.name, name));
    return;
  }
  std::string material;
  for (std::string_view text = text_of(*bytes); !text.empty();) {
    std::string_view line = next_line(text);
    const std::string_view word = next_word(line);
    if (word == "newmtl") material = trimmed(line);
    if (word == "Kd") scan.with_color.insert(material);
  }
}

Status check_line(std::string_view line, size_t number, const SourceFile& source, ObjScan& scan,
                  std::vector<std::string>& warnings) {
  const std::string_view word = next_word(line);
  const bool is_v = word == "v", is_vt = word == "vt", is_vn = word == "vn", is_f = word == "f";
  if (word == "mtllib") read_library(line, source, scan, warnings);
  if (!is_v && !is_vt && !is_vn && !is_f) return {};
  const std::string where = fmt::format("{}, line {}", source.name, number);
  scan.counts.v += is_v;
  scan.counts.vt += is_vt;
  scan.counts.vn += is_vn;
  if (!is_f) return check_numbers(line, where);
  scan.has_faces = true;
  return check_corners(line, scan, number, where);
}

}  // namespace

Result<std::set<std::string>> check_obj(const SourceFile& source,
                                        std::vector<std::string>& warnings) {
  std::string_view text = text_of(source.bytes);
  ObjScan scan;
  for (size_t number = 1; !text.empty(); ++number) {
    LUXEL_TRY_STATUS(check_line(next_line(text), number, source, scan, warnings));
  }
  const std::pair<const char*, int64_t> lists[3] = {{"vertices", scan.counts.v},
                                                    {"texture coordinates", scan.counts.vt},
                                                    {"normals", scan.counts.vn}};
  for (size_t k = 0; k < 3; ++k)
    if (scan.largest[k].value > lists[k].second)
      return fail(ErrorCode::bad_input, "{}, line {}: index {} is out of range, there are {} {}",
                  source.name, scan.largest[k].line, scan.largest[k].value, lists[k].second,
                  lists[k].first);
  if (!scan.has_faces)
    return fail(ErrorCode::bad_input, "{}: the scene has no triangles; nothing can be lit",
                source.name);
  return std::move(scan.with_color);
}

}  // namespace luxel::import
