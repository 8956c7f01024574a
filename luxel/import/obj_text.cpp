#include "luxel/import/obj_text.h"

#include <array>
#include <charconv>
#include <map>

#include "luxel/import/polygon.h"
#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

constexpr std::string_view kFreeForm = "surf";

/// An index of a face, and the first line that has it.
struct LargestIndex {
  uint64_t value = 0;
  size_t line = 0;
};

struct Scan {
  ObjCounts counts;
  std::array<LargestIndex, 3> largest;
  uint64_t changes = 0;  ///< lines that change the state of faces
  bool has_colors = false;
  size_t free_form = 0;
};

bool is_face(std::string_view keyword) { return keyword == "f" || keyword == "fo"; }

/// The words of a line of numbers, up to a comment; of too many, one more than a face may have.
std::vector<std::string_view> words_before_comment(std::string_view rest) {
  std::vector<std::string_view> out;
  rest = rest.substr(0, rest.find('#'));
  for (std::string_view word; out.size() <= kMostCorners && !(word = next_word(rest)).empty();)
    out.push_back(word);
  return out;
}

Status check_numbers(const std::vector<std::string_view>& words, size_t least,
                     const std::string& where) {
  for (const std::string_view word : words)
    if (!finite_number(word))
      return fail(ErrorCode::bad_input, "{}: '{}' is not a finite number", where, word);
  if (words.size() < least)
    return fail(ErrorCode::bad_input, "{}: {} numbers, must be {}", where, words.size(), least);
  return {};
}

/// The corner v, v/vt, v//vn or v/vt/vn, from 1 on; 0: not given. Negative ones count back from
/// what came before.
Result<std::array<uint64_t, 3>> corner_of(std::string_view corner, const ObjCounts& counts,
                                          const std::string& where) {
  const uint64_t before[3] = {counts.v, counts.vt, counts.vn};
  std::array<uint64_t, 3> out{};
  for (size_t k = 0; k < 3 && !corner.empty(); ++k) {
    const size_t slash = std::min(corner.find('/'), corner.size());
    const std::string_view word = corner.substr(0, slash);
    corner.remove_prefix(std::min(slash + 1, corner.size()));
    if (word.empty() && k > 0) continue;
    int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      return fail(ErrorCode::bad_input, "{}: '{}' is not a vertex index", where, word);
    if (value < 0) value += int64_t(before[k]) + 1;
    if (value < 1)
      return fail(ErrorCode::bad_input, "{}: index {} is out of range; {} come before", where, word,
                  before[k]);
    out[k] = uint64_t(value);
  }
  return out;
}

Status check_face(const std::vector<std::string_view>& words, size_t line, const std::string& where,
                  Scan& scan) {
  if (words.size() > kMostCorners)
    return fail(ErrorCode::bad_input, "{}: the face has more than {} corners; divide it", where,
                kMostCorners);
  for (const std::string_view word : words) {
    LUXEL_TRY(const auto corner, corner_of(word, scan.counts, where));
    for (size_t k = 0; k < 3; ++k)
      if (corner[k] > scan.largest[k].value) scan.largest[k] = {corner[k], line};
  }
  if (words.size() < 3) return {};  // a point or a line
  ++scan.counts.faces, scan.counts.corners += words.size();
  return {};
}

Status check_line(const ObjLine& line, const SourceFile& source, Scan& scan, MtlLibrary& library,
                  std::vector<std::string>& warnings) {
  std::string_view rest = line.text;
  const std::string_view keyword = next_word(rest);
  scan.changes += keyword == "o" || keyword == "g" || keyword == "s" || keyword == "usemtl";
  scan.free_form += keyword == kFreeForm;
  if (keyword == "mtllib") add_libraries(rest, source, library, warnings);
  const bool is_v = keyword == "v", is_vt = keyword == "vt", is_vn = keyword == "vn";
  if (!is_v && !is_vt && !is_vn && !is_face(keyword)) return {};
  const std::string where = fmt::format("{}, line {}", source.name, line.number);
  const std::vector<std::string_view> words = words_before_comment(rest);
  if (is_face(keyword)) return check_face(words, line.number, where, scan);
  scan.counts.v += is_v, scan.counts.vt += is_vt, scan.counts.vn += is_vn;
  scan.has_colors |= is_v && words.size() >= 6;
  return check_numbers(words, is_vt ? 1 : 3, where);
}

Status check_all_lines(const SourceFile& source, Scan& scan, MtlLibrary& library,
                       std::vector<std::string>& warnings) {
  std::string_view text = text_of(source.bytes);
  for (ObjLine line; next_obj_line(text, line);)
    LUXEL_TRY_STATUS(check_line(line, source, scan, library, warnings));
  // Faces may refer ahead, in the files of some exporters.
  const std::pair<const char*, uint64_t> lists[3] = {{"vertices", scan.counts.v},
                                                     {"texture coordinates", scan.counts.vt},
                                                     {"normals", scan.counts.vn}};
  for (size_t k = 0; k < 3; ++k)
    if (scan.largest[k].value > lists[k].second)
      return fail(ErrorCode::bad_input, "{}, line {}: index {} is out of range, there are {} {}",
                  source.name, scan.largest[k].line, scan.largest[k].value, lists[k].second,
                  lists[k].first);
  if (scan.free_form > 0)
    warnings.push_back(
        fmt::format("{}: free-form surfaces are left out: {}; export them as polygons", source.name,
                    scan.free_form));
  if (scan.counts.faces == 0)
    return fail(ErrorCode::bad_input, "{}: the scene has no triangles; nothing can be lit",
                source.name);
  return {};
}

/// Numbers for names, in the order of their first use.
template <class Name>
struct Numbered {
  std::map<Name, uint32_t> number;
  uint32_t of(const Name& name) {
    return number.try_emplace(name, uint32_t(number.size())).first->second;
  }
};

/// The second walk, up to the line that it has come to.
struct Writing {
  ObjText& out;
  ObjCounts so_far;
  std::string object, group;
  ObjState state;
  bool is_new_state = true;
  Numbered<std::pair<std::string, std::string>> groups;  ///< of (o, g)
  Numbered<std::string> materials;
};

void put_numbers(const char* keyword, std::vector<std::string_view> words, size_t count,
                 std::string& text) {
  words.resize(count, "0");
  text += keyword;
  for (const std::string_view word : words) text.append(" ").append(word);
  text += '\n';
}

void put_vertex(const std::vector<std::string_view>& words, Writing& writing) {
  ++writing.so_far.v;
  put_numbers("v", words, 3, writing.out.text);
  if (writing.out.colors.empty() || words.size() < 6) return;
  writing.out.colors[size_t(writing.so_far.v - 1)] = {
      *finite_number(words[3]), *finite_number(words[4]), *finite_number(words[5])};
}

void put_face(const std::vector<std::string_view>& words, size_t line, Writing& writing) {
  if (words.size() < 3) return;
  ObjText& out = writing.out;
  if (writing.is_new_state) {
    out.text += fmt::format("g {}\n", out.states.size());
    out.states.push_back(writing.state);
    writing.is_new_state = false;
  }
  out.text += 'f';
  for (const std::string_view word : words) {
    const auto corner = corner_of(word, writing.so_far, "");
    LUXEL_CHECK(corner);  // it was checked
    out.text += fmt::format(" {}/{}/{}", (*corner)[0], (*corner)[1], (*corner)[2]);
  }
  out.text += '\n';
  out.lines.push_back(uint32_t(line));
}

void put_state(std::string_view keyword, std::string_view rest, Writing& writing) {
  const std::string name(trimmed(rest));
  ObjState& state = writing.state;
  if (keyword == "usemtl") {
    state.material = writing.materials.of(std::string(without_quotes(name)));
    writing.out.materials.resize(writing.materials.number.size());
    writing.out.materials[state.material] = without_quotes(name);
  } else if (keyword == "s") {
    state.smoothing = 0;  // "off"
    std::from_chars(name.data(), name.data() + name.size(), state.smoothing);
    writing.out.states_smoothing = true;
  } else {
    if (keyword == "o") writing.object = name;
    writing.group = keyword == "g" ? name : std::string();
    state.group = writing.groups.of({writing.object, writing.group});
    writing.out.groups.resize(writing.groups.number.size());
    writing.out.groups[state.group] = writing.group.empty() ? writing.object : writing.group;
  }
  writing.is_new_state = true;
}

void put_line(const ObjLine& line, Writing& writing) {
  std::string_view rest = line.text;
  const std::string_view keyword = next_word(rest);
  if (keyword == "v") {
    put_vertex(words_before_comment(rest), writing);
  } else if (keyword == "vt") {
    ++writing.so_far.vt;
    put_numbers("vt", words_before_comment(rest), 2, writing.out.text);
  } else if (keyword == "vn") {
    ++writing.so_far.vn;
    put_numbers("vn", words_before_comment(rest), 3, writing.out.text);
  } else if (is_face(keyword)) {
    put_face(words_before_comment(rest), line.number, writing);
  } else if (keyword == "o" || keyword == "g" || keyword == "s" || keyword == "usemtl") {
    put_state(keyword, rest, writing);
  }
}

/// The most bytes that the text and the scene take that is read from it. A line that changes the
/// state may bring a mesh and a material. A corner takes an index of three numbers, a vertex in the
/// file's and in the scene's form, a node of a map and a triangle; in the text it may be longer
/// than in the file, where it may be written from behind.
uint64_t most_bytes(const SourceFile& source, const Scan& scan) {
  const ObjCounts& n = scan.counts;
  return 2 * source.bytes.size() + 1024 * scan.changes + 24 * n.v + 16 * n.vt + 24 * n.vn +
         (scan.has_colors ? 12 * n.v : 0) + 240 * n.corners + 40 * n.faces;
}

}  // namespace

Result<ObjText> plain_obj(const SourceFile& source, std::vector<std::string>& warnings) {
  ObjText out;
  Scan scan;
  LUXEL_TRY_STATUS(check_all_lines(source, scan, out.library, warnings));
  LUXEL_TRY_STATUS(source.memory.take(most_bytes(source, scan), "the surfaces of " + source.name));
  out.counts = scan.counts;
  out.text.reserve(source.bytes.size());
  out.lines.reserve(size_t(scan.counts.faces));
  if (scan.has_colors) out.colors.assign(size_t(scan.counts.v), Rgb{1, 1, 1});
  Writing writing{out, {}, {}, {}, {}, true, {}, {}};
  writing.groups.of({"", ""}), writing.materials.of("");
  out.groups = {""}, out.materials = {""};
  std::string_view text = text_of(source.bytes);
  for (ObjLine line; next_obj_line(text, line);) put_line(line, writing);
  return out;
}

}  // namespace luxel::import
