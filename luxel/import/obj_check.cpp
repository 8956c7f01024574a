// A look over an .obj file before Assimp gets it.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "luxel/base/vec_double.h"
#include "luxel/import/mtl_text.h"
#include "luxel/import/readers.h"
#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

/// How many of each the file has so far; faces may only refer back or, in the files of some
/// exporters, ahead: indices are judged at the end.
struct ObjCounts {
  int64_t v = 0, vt = 0, vn = 0;
};

struct Index {
  int64_t value = 0;  ///< from 1 on; 0 or less is out of range
  size_t line = 0;
};

/// Faces of four corners or more that do not lie in one plane.
struct BentFaces {
  size_t count = 0;
  size_t first_line = 0;
  std::set<std::string> groups;
};

struct ObjScan {
  ObjCounts counts;
  Index largest[3];
  bool has_faces = false;
  MtlText materials;
  std::vector<DVec3> positions;
  std::string group;
  BentFaces bent;
};

/// Every number of a v, vt or vn line must be one, and finite. The first three go to `first`.
Status check_numbers(std::string_view rest, const std::string& where, DVec3& first) {
  double* const coordinate[3] = {&first.x, &first.y, &first.z};
  size_t count = 0;
  for (std::string_view word; !(word = next_word(rest)).empty();) {
    if (word.front() == '#') break;
    const std::optional<float> value = finite_number(word);
    if (!value) return fail(ErrorCode::bad_input, "{}: '{}' is not a finite number", where, word);
    if (count < 3) *coordinate[count++] = double(*value);
  }
  return {};
}

/// True when a corner lies further from the plane of the others than the rounding of printed
/// numbers and a 100,000th of the face's size explain. `corners` are indices from 1 on; those that
/// refer ahead are not judged.
bool is_bent(const std::vector<int64_t>& corners, const std::vector<DVec3>& positions) {
  DVec3 twice_area;
  double size = 0, magnitude = 0;
  const auto at = [&](size_t k) { return positions[size_t(corners[k] - 1)]; };
  for (size_t k = 0; k < corners.size(); ++k) {
    if (corners[k] > int64_t(positions.size())) return false;
    const DVec3 r = at(k) - at(0);
    size = std::max(size, length(r));
    magnitude = std::max({magnitude, std::abs(at(k).x), std::abs(at(k).y), std::abs(at(k).z)});
    if (k >= 2) twice_area += cross(at(k - 1) - at(0), r);
  }
  const DVec3 normal = normalize(twice_area);
  double lowest = 0, highest = 0;
  for (size_t k = 1; k < corners.size(); ++k) {
    const double height = dot(normal, at(k) - at(0));
    lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
  return highest - lowest > 1e-5 * size + 1e-6 * magnitude;
}

void note_bent_face(const std::vector<int64_t>& corners, size_t line, ObjScan& scan) {
  if (corners.size() < 4 || !is_bent(corners, scan.positions)) return;
  if (scan.bent.count++ == 0) scan.bent.first_line = line;
  scan.bent.groups.insert(scan.group);
}

/// "it has 3 faces that are not planar, the first in line 12, in the groups a, b; ..."
std::string bent_faces_warning(const std::string& name, const BentFaces& bent) {
  constexpr size_t kMostNames = 5;
  std::string groups;
  size_t listed = 0;
  for (const std::string& group : bent.groups) {
    if (listed++ == kMostNames) break;
    groups += fmt::format("{}'{}'", listed == 1 ? "" : ", ", group);
  }
  if (bent.groups.size() > kMostNames)
    groups += fmt::format(" and {} more", bent.groups.size() - kMostNames);
  return fmt::format(
      "{}: {} whose corners do not lie in one plane {} split into triangles, the "
      "first in line {}; in {}",
      name, bent.count == 1 ? "1 face" : fmt::format("{} faces", bent.count),
      bent.count == 1 ? "is" : "are", bent.first_line, groups);
}

/// The corners v, v/vt, v//vn, v/vt/vn of an f line.
Status check_corners(std::string_view rest, ObjScan& scan, size_t line, const std::string& where) {
  const int64_t counts[3] = {scan.counts.v, scan.counts.vt, scan.counts.vn};
  std::vector<int64_t> corners;
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
      if (k == 0) corners.push_back(value);
    }
  }
  note_bent_face(corners, line, scan);
  return {};
}

Status check_line(std::string_view line, size_t number, const SourceFile& source, ObjScan& scan,
                  std::vector<std::string>& warnings) {
  const std::string_view word = next_word(line);
  const bool is_v = word == "v", is_vt = word == "vt", is_vn = word == "vn", is_f = word == "f";
  if (word == "mtllib") add_libraries(line, source, scan.materials, warnings);
  if (word == "o" || word == "g") scan.group = trimmed(line);
  if (!is_v && !is_vt && !is_vn && !is_f) return {};
  const std::string where = fmt::format("{}, line {}", source.name, number);
  scan.counts.v += is_v;
  scan.counts.vt += is_vt;
  scan.counts.vn += is_vn;
  if (!is_f) {
    DVec3 numbers;
    LUXEL_TRY_STATUS(check_numbers(line, where, numbers));
    if (is_v) scan.positions.push_back(numbers);
    return {};
  }
  scan.has_faces = true;
  return check_corners(line, scan, number, where);
}

}  // namespace

Result<MtlText> check_obj(const SourceFile& source, std::vector<std::string>& warnings) {
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
  if (scan.bent.count > 0) warnings.push_back(bent_faces_warning(source.name, scan.bent));
  return std::move(scan.materials);
}

}  // namespace luxel::import
