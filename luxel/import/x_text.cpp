// A text .x file read by its own rules and written plainly for Assimp: Assimp takes a stray ; for
// an object and skips what follows, takes a comma for a decimal point, and ends the process for a
// normal or a material that is not there.
#include <charconv>
#include <string>
#include <string_view>

#include "luxel/import/readers.h"
#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

/// Frames in frames; Assimp calls itself for each.
constexpr int kDeepest = 1000;

/// Takes words, { and } off the text; ; and , only separate. The file has ended when a word is
/// empty.
struct Words {
  std::string_view text;
  size_t at = 0;
  size_t line = 1;

  std::string_view next() {
    skip_blanks();
    const size_t start = at;
    if (at == text.size()) return {};
    if (text[at] == '{' || text[at] == '}') return text.substr(at++, 1);
    if (text[at] == '"') {
      at = std::min(text.find('"', at + 1), text.size() - 1) + 1;
      return text.substr(start, at - start);
    }
    at = std::min(text.find_first_of(" \t\r\n\v\f;,{}", at), text.size());
    return text.substr(start, at - start);
  }

 private:
  void skip_blanks() {
    for (; at < text.size(); ++at) {
      if (text[at] == '\n') ++line;
      if (text[at] == '#' || text.substr(at, 2) == "//") {
        at = std::min(text.find_first_of("\r\n", at), text.size()) - 1;
      } else if (std::string_view(" \t\r\n\v\f;,").find(text[at]) == std::string_view::npos) {
        return;
      }
    }
  }
};

/// The rest of a file, and the text written from it so far.
struct Walk {
  const SourceFile& source;
  Words words;
  std::string plain;
  DBox3 box = {};   ///< of all vertices
  DVec3 near = {};  ///< what they are written relative to

  template <class... Parts>
  void write(fmt::format_string<Parts...> format, Parts&&... parts) {
    fmt::format_to(std::back_inserter(plain), format, std::forward<Parts>(parts)...);
  }

  template <class... Parts>
  Failure error(fmt::format_string<Parts...> format, Parts&&... parts) const {
    return fail(ErrorCode::bad_input, "{}, line {}: {}", source.name, words.line,
                fmt::format(format, std::forward<Parts>(parts)...));
  }
};

Result<std::string_view> next_word(Walk& walk) {
  const std::string_view word = walk.words.next();
  if (word.empty()) return walk.error("the file ends early");
  return word;
}

/// A whole number below `limit`; `what` says of what.
Result<uint64_t> next_index(Walk& walk, uint64_t limit, const char* what) {
  LUXEL_TRY(const std::string_view word, next_word(walk));
  int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size())
    return walk.error("'{}' is not a whole number", word);
  if (error != std::errc() || value < 0 || uint64_t(value) >= limit)
    return walk.error("{} {} is out of range, there are {}", what, word, limit);
  return uint64_t(value);
}

/// The number of things that follow, each of which takes at least one byte.
Result<uint64_t> next_count(Walk& walk) {
  const uint64_t left = walk.words.text.size() - walk.words.at;
  LUXEL_TRY(const std::string_view word, next_word(walk));
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size())
    return walk.error("'{}' is not a count", word);
  if (error != std::errc() || value > left)
    return walk.error("the count {} is more than the rest of the file holds", word);
  return value;
}

/// A finite number.
template <class T = float>
Result<T> next_number(Walk& walk) {
  LUXEL_TRY(const std::string_view word, next_word(walk));
  // Old compilers print this for a number that is none; Assimp takes it for 0, too.
  if (word.find(".#IND") != word.npos || word.find(".#QNAN") != word.npos) return T(0);
  if (const auto value = finite_number<T>(word); value && std::isfinite(float(*value)))
    return *value;
  return walk.error("'{}' is not a finite number", word);
}

/// `count` vectors or colours of `size` numbers each.
Status copy_vectors(Walk& walk, uint64_t count, int size) {
  for (uint64_t i = 0; i < count; ++i) {
    for (int k = 0; k < size; ++k) {
      LUXEL_TRY(const float number, next_number(walk));
      walk.write("{};", number);
    }
    walk.write(";");
  }
  return {};
}

/// The vertices of a mesh, less `near`; the box gets them as they stand.
Status copy_vertices(Walk& walk, uint64_t count) {
  for (uint64_t i = 0; i < count; ++i) {
    DVec3 p;
    for (double* coordinate : {&p.x, &p.y, &p.z}) {
      LUXEL_TRY(*coordinate, next_number<double>(walk));
    }
    walk.box.extend(p);
    const Vec3 q = to_float(p - walk.near);
    walk.write("{};{};{};;", q.x, q.y, q.z);
  }
  return {};
}

/// To the brace that closes what is open.
Status skip_to_end(Walk& walk) {
  for (int open = 1; open > 0;) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    open += word == "{" ? 1 : word == "}" ? -1 : 0;
  }
  return {};
}

/// A name without what would end it.
std::string plain_name(std::string_view word) {
  std::string name(word);
  for (char& c : name)
    if (uint8_t(c) <= ' ' || std::string_view("\";,{}#/").find(c) != std::string_view::npos)
      c = '_';
  return name;
}

/// An optional name, which it returns, and the opening brace.
Result<std::string> enter(Walk& walk) {
  LUXEL_TRY(std::string_view word, next_word(walk));
  std::string name;
  if (word != "{") {
    name = plain_name(word);
    LUXEL_TRY(word, next_word(walk));
  }
  if (word != "{") return walk.error("'{}' stands in place of '{{'", word);
  return name;
}

/// An object that is left out.
Status skip_object(Walk& walk, std::string_view word) {
  if (word != "{") LUXEL_TRY_STATUS(enter(walk));  // a reference has no name before its brace
  return skip_to_end(walk);
}

/// A list of faces, each a list of indices below `limit`.
Status copy_faces(Walk& walk, uint64_t faces, uint64_t limit, const char* what) {
  for (uint64_t f = 0; f < faces; ++f) {
    LUXEL_TRY(const uint64_t corners, next_count(walk));
    if (corners == 0) return walk.error("a face has no corner");
    walk.write("{};", corners);
    for (uint64_t c = 0; c < corners; ++c) {
      LUXEL_TRY(const uint64_t index, next_index(walk, limit, what));
      walk.write("{};", index);
    }
    walk.write(";");
  }
  return {};
}

struct MeshSize {
  uint64_t vertices = 0, faces = 0;
};

Status check_equal(const Walk& walk, uint64_t count, const char* what, uint64_t wanted,
                   const char* of) {
  if (count != wanted)
    return walk.error("there are {} {}, but the mesh has {} {}", count, what, wanted, of);
  return {};
}

Status copy_normals(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t normals, next_count(walk));
  walk.write("MeshNormals {{\n{};", normals);
  LUXEL_TRY_STATUS(copy_vectors(walk, normals, 3));
  LUXEL_TRY(const uint64_t faces, next_count(walk));
  LUXEL_TRY_STATUS(check_equal(walk, faces, "faces with normals", mesh.faces, "faces"));
  walk.write("\n{};", faces);
  LUXEL_TRY_STATUS(copy_faces(walk, faces, normals, "normal index"));
  walk.write("}}\n");
  return skip_to_end(walk);
}

Status copy_coordinates(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t count, next_count(walk));
  LUXEL_TRY_STATUS(check_equal(walk, count, "texture coordinates", mesh.vertices, "vertices"));
  walk.write("MeshTextureCoords {{\n{};", count);
  LUXEL_TRY_STATUS(copy_vectors(walk, count, 2));
  walk.write("}}\n");
  return skip_to_end(walk);
}

Status copy_colors(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t count, next_count(walk));
  LUXEL_TRY_STATUS(check_equal(walk, count, "vertex colours", mesh.vertices, "vertices"));
  walk.write("MeshVertexColors {{\n{};", count);
  for (uint64_t i = 0; i < count; ++i) {
    LUXEL_TRY(const uint64_t vertex, next_index(walk, mesh.vertices, "the vertex of a colour"));
    walk.write("{};", vertex);
    LUXEL_TRY_STATUS(copy_vectors(walk, 1, 4));
  }
  walk.write("}}\n");
  return skip_to_end(walk);
}

/// `Material NAME { ... }`, from its name on.
Status copy_material(Walk& walk) {
  LUXEL_TRY(const std::string name, enter(walk));
  walk.write("Material {} {{\n", name);
  LUXEL_TRY_STATUS(copy_vectors(walk, 1, 4));  // what it reflects
  LUXEL_TRY(const float sharpness, next_number(walk));
  walk.write("{};", sharpness);
  LUXEL_TRY_STATUS(copy_vectors(walk, 2, 3));  // highlight, emission
  for (;;) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    if (word == "}") break;
    if (word != "TextureFilename" && word != "TextureFileName") {
      LUXEL_TRY_STATUS(skip_object(walk, word));
      continue;
    }
    LUXEL_TRY_STATUS(enter(walk));
    LUXEL_TRY(const std::string_view file, next_word(walk));
    if (file.size() < 2 || !file.starts_with('"') || !file.ends_with('"'))
      return walk.error("'{}' stands in place of a picture's name in quotes", file);
    walk.write("TextureFilename {{ {}; }}\n", file);
    LUXEL_TRY_STATUS(skip_to_end(walk));
  }
  walk.write("}}\n");
  return {};
}

/// The faces' material indices come before the materials that they count.
Status copy_materials(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t stated, next_count(walk));  // those that are there count
  LUXEL_TRY(const uint64_t faces, next_count(walk));
  if (faces != 1 || mesh.faces == 0)
    LUXEL_TRY_STATUS(check_equal(walk, faces, "material indices", mesh.faces, "faces"));
  walk.write("MeshMaterialList {{\n{};{};", stated, faces);
  uint64_t largest = 0;
  for (uint64_t i = 0; i < faces; ++i) {
    LUXEL_TRY(const uint64_t index, next_index(walk, UINT32_MAX, "material index"));
    walk.write("{};", index);
    largest = std::max(largest, index);
  }
  uint64_t materials = 0;
  for (;;) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    if (word == "}") break;
    materials += word == "Material" || word == "{";
    if (word == "Material") {
      LUXEL_TRY_STATUS(copy_material(walk));
      continue;
    }
    if (word == "{") {
      LUXEL_TRY(const std::string_view name, next_word(walk));
      if (name == "}") return walk.error("a reference to a material has no name");
      walk.write("{{ {} }}\n", plain_name(name));
    }
    LUXEL_TRY_STATUS(word == "{" ? skip_to_end(walk) : skip_object(walk, word));
  }
  walk.write("}}\n");
  if (mesh.faces > 0 && largest >= materials)
    return walk.error("material index {} is out of range, the mesh lists {}", largest, materials);
  return {};
}

/// `Mesh NAME { ... }`, from its name on. One without faces is left out.
Status copy_mesh(Walk& walk) {
  const size_t before = walk.plain.size();
  MeshSize mesh;
  // Vertices and faces.
  LUXEL_TRY(const std::string name, enter(walk));
  LUXEL_TRY(mesh.vertices, next_count(walk));
  walk.write("Mesh {} {{\n{};", name, mesh.vertices);
  LUXEL_TRY_STATUS(copy_vertices(walk, mesh.vertices));
  LUXEL_TRY(mesh.faces, next_count(walk));
  walk.write("\n{};", mesh.faces);
  LUXEL_TRY_STATUS(copy_faces(walk, mesh.faces, mesh.vertices, "vertex index"));
  // The objects inside, in any order. Bones are among those that are left out.
  for (;;) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    if (word == "}") break;
    const bool is_copied = word == "MeshNormals" || word == "MeshTextureCoords" ||
                           word == "MeshVertexColors" || word == "MeshMaterialList";
    if (is_copied) LUXEL_TRY_STATUS(enter(walk));
    if (word == "MeshNormals")
      LUXEL_TRY_STATUS(copy_normals(walk, mesh));
    else if (word == "MeshTextureCoords")
      LUXEL_TRY_STATUS(copy_coordinates(walk, mesh));
    else if (word == "MeshVertexColors")
      LUXEL_TRY_STATUS(copy_colors(walk, mesh));
    else if (word == "MeshMaterialList")
      LUXEL_TRY_STATUS(copy_materials(walk, mesh));
    else
      LUXEL_TRY_STATUS(skip_object(walk, word));
  }
  walk.write("}}\n");
  if (mesh.faces == 0) walk.plain.resize(before);
  return {};
}

/// `FrameTransformMatrix { ... }`, from its brace on.
Status copy_matrix(Walk& walk) {
  LUXEL_TRY_STATUS(enter(walk));
  walk.write("FrameTransformMatrix {{\n");
  LUXEL_TRY_STATUS(copy_vectors(walk, 1, 16));
  walk.write("}}\n");
  return skip_to_end(walk);
}

/// Frames with meshes and materials, in each other; all else is left out.
Status copy_objects(Walk& walk) {
  int depth = 0;
  for (std::string_view word; !(word = walk.words.next()).empty();) {
    if (word == "}") {
      if (depth > 0) walk.write("}}\n");
      depth = std::max(depth - 1, 0);
    } else if (word == "Frame") {
      LUXEL_TRY(const std::string name, enter(walk));
      walk.write("Frame {} {{\n", name);
      if (++depth > kDeepest) return walk.error("more than {} frames are nested", kDeepest);
    } else {
      const bool is_top = depth == 0;
      LUXEL_TRY_STATUS(word == "Mesh"                              ? copy_mesh(walk)
                       : word == "Material" && is_top              ? copy_material(walk)
                       : word == "FrameTransformMatrix" && !is_top ? copy_matrix(walk)
                                                                   : skip_object(walk, word));
    }
  }
  if (depth > 0) return walk.error("the file ends early: a frame is not closed");
  return {};
}

}  // namespace

Result<std::optional<std::string>> write_plain_x(const SourceFile& source, DVec3& near) {
  std::string_view text = text_of(source.bytes);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  // Binary and packed files, and what is no .x at all, are left to Assimp.
  if (text.size() < 12 || !text.starts_with("xof ") || text.substr(8, 4) != "txt ")
    return std::nullopt;
  // 1e9 becomes 1e+09;
  LUXEL_TRY_STATUS(source.memory.take(3 * text.size(), "the text of " + source.name));
  const Words words{text, std::min(text.find('\n'), text.size())};
  const std::string head = "xof 0303txt 0032\n";
  Walk walk{source, words, head};
  LUXEL_TRY_STATUS(copy_objects(walk));
  const DVec3 off = origin_for(walk.box);
  if (off == DVec3{}) return std::move(walk.plain);
  near = {off.x, off.y, -off.z};  // Assimp turns Direct3D's left-handed space round
  walk.words = words, walk.plain = head, walk.near = off;
  LUXEL_TRY_STATUS(copy_objects(walk));
  return std::move(walk.plain);
}

}  // namespace luxel::import
