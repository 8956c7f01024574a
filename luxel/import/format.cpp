#include "luxel/import/format.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "luxel/import/text_lines.h"
#include "luxel/import/xml_text.h"

namespace luxel::import {
namespace {

constexpr std::array<std::string_view, 8> kOwnFormats{".dae", ".fbx", ".glb", ".gltf",
                                                      ".obj", ".ply", ".stl", ".x"};

/// The first element of XML text, behind comments and the like; empty: it is none.
std::string_view first_element(std::string_view text) {
  const auto tag = text.starts_with('<') ? next_tag(text, 0) : std::nullopt;
  return tag ? tag->name : std::string_view();
}

/// .obj files have no mark. Files of other formats have other words in their first lines, or no
/// line `v 1 2 3`.
bool is_obj(std::string_view text) {
  constexpr std::array<std::string_view, 12> kWords{"v", "vn", "vt",     "f",      "o",  "g",
                                                    "s", "l",  "usemtl", "mtllib", "vp", "p"};
  constexpr size_t kLines = 100;
  bool has_vertex = false;
  ObjLine line;
  for (size_t seen = 0; seen < kLines && next_obj_line(text, line);) {
    std::string_view rest = trimmed(line.text);
    if (rest.empty() || rest.starts_with('#')) continue;
    const std::string_view word = next_word(rest);
    if (std::ranges::find(kWords, word) == kWords.end()) return false;
    bool is_point = word == "v";
    for (int k = 0; k < 3 && is_point; ++k) is_point = finite_number(next_word(rest)).has_value();
    has_vertex |= is_point;
    ++seen;
  }
  return has_vertex;
}

}  // namespace

bool is_binary_stl(std::string_view file) {
  constexpr size_t kHead = 80, kFacet = 50;
  uint32_t facets = 0;
  if (file.size() < kHead + sizeof facets) return false;
  std::memcpy(&facets, file.data() + kHead, sizeof facets);
  return facets > 0 && file.size() == kHead + sizeof facets + kFacet * uint64_t(facets);
}

std::string format_of(const std::vector<std::byte>& bytes, const std::string& ending) {
  const std::string_view file = text_of(bytes);
  if (file.starts_with("glTF")) return ".glb";
  if (file.starts_with("Kaydara FBX Binary")) return ".fbx";
  if (file.starts_with("xof ")) return ".x";
  if (file.starts_with("ply\n") || file.starts_with("ply\r")) return ".ply";
  if (is_binary_stl(file)) return ".stl";
  std::string_view text = file;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(kXmlBlanks), text.size()));
  constexpr size_t kHead = 2000;
  const std::string_view head = text.substr(0, kHead);
  if (text.starts_with('{') && text.find("\"asset\"") != text.npos) return ".gltf";
  if (first_element(text) == "COLLADA") return ".dae";
  if (text.starts_with("solid") && head.find("facet") != head.npos) return ".stl";
  if ((text.starts_with(';') || text.starts_with("FBX")) && head.find("FBX") != head.npos)
    return ".fbx";
  return is_obj(text) ? ".obj" : ending;
}

bool is_own_format(const std::string& extension) {
  return std::ranges::find(kOwnFormats, extension) != kOwnFormats.end();
}

Status check_format(const SourceFile& source) {
  if (is_own_format(source.extension)) return {};
  if (const std::string name = name_in_assimp(source.path); !name.empty())
    return fail(ErrorCode::unsupported,
                "{}: {} files ({}) are read only with --any-format, in a process of their own; "
                "convert it to glTF (.glb)",
                source.name, source.extension, name);
  std::string list;
  for (const std::string_view extension : kOwnFormats) list.append(" ").append(extension);
  return fail(ErrorCode::unsupported,
              "{}: neither its content nor its ending '{}' is of a format that luxel reads:{}; "
              "convert it to glTF (.glb)",
              source.name, source.extension, list);
}

}  // namespace luxel::import
