// A walk through a text .x file before Assimp gets it: Assimp takes every count and index of a mesh
// on trust, and ends the process for a normal, a weight or a material that is not there.
#include <charconv>
#include <cmath>
#include <string_view>

#include "luxel/import/readers.h"

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

struct Walk {
  const SourceFile& source;
  Words words;

  template <class... Parts>
  tl::unexpected<Error> error(fmt::format_string<Parts...> format, Parts&&... parts) const {
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

/// How many things follow, each of which takes at least one byte.
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

Status skip_numbers(Walk& walk, uint64_t count) {
  for (uint64_t i = 0; i < count; ++i) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    // What old compilers print for a number that is none; Assimp takes it for 0.
    if (word.find(".#IND") != word.npos || word.find(".#QNAN") != word.npos) continue;
    if (error == std::errc::invalid_argument || end != word.data() + word.size() ||
        !std::isfinite(value))
      return walk.error("'{}' is not a finite number", word);
    // Assimp takes 1,5 for one number, 1.5, and all that follows for something else.
    const std::string_view rest = walk.words.text.substr(walk.words.at);
    const bool is_whole = word.find_first_not_of("+-0123456789") == word.npos;
    if (is_whole && rest.size() > 1 && rest[0] == ',' && rest[1] >= '0' && rest[1] <= '9')
      return walk.error("a comma and a digit follow {}; write {}.0", word, word);
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

/// An optional name and the opening brace.
Status enter(Walk& walk) {
  LUXEL_TRY(std::string_view word, next_word(walk));
  if (word != "{") {
    LUXEL_TRY(word, next_word(walk));
  }
  if (word != "{") return walk.error("'{}' stands where '{{' should", word);
  return {};
}

/// A list of faces, each a list of indices below `limit`.
Status check_faces(Walk& walk, uint64_t faces, uint64_t limit, const char* what) {
  for (uint64_t f = 0; f < faces; ++f) {
    LUXEL_TRY(const uint64_t corners, next_count(walk));
    if (corners == 0) return walk.error("a face has no corner");
    for (uint64_t c = 0; c < corners; ++c) {
      LUXEL_TRY_STATUS(next_index(walk, limit, what));
    }
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

Status check_normals(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t normals, next_count(walk));
  LUXEL_TRY_STATUS(skip_numbers(walk, 3 * normals));
  LUXEL_TRY(const uint64_t faces, next_count(walk));
  LUXEL_TRY_STATUS(check_equal(walk, faces, "faces with normals", mesh.faces, "faces"));
  LUXEL_TRY_STATUS(check_faces(walk, faces, normals, "normal index"));
  return skip_to_end(walk);
}

Status check_coordinates(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t count, next_count(walk));
  LUXEL_TRY_STATUS(check_equal(walk, count, "texture coordinates", mesh.vertices, "vertices"));
  LUXEL_TRY_STATUS(skip_numbers(walk, 2 * count));
  return skip_to_end(walk);
}

Status check_colors(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY(const uint64_t count, next_count(walk));
  LUXEL_TRY_STATUS(check_equal(walk, count, "vertex colours", mesh.vertices, "vertices"));
  for (uint64_t i = 0; i < count; ++i) {
    LUXEL_TRY_STATUS(next_index(walk, mesh.vertices, "the vertex of a colour"));
    LUXEL_TRY_STATUS(skip_numbers(walk, 4));
  }
  return skip_to_end(walk);
}

Status check_weights(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY_STATUS(next_word(walk));  // the bone's name
  LUXEL_TRY(const uint64_t count, next_count(walk));
  for (uint64_t i = 0; i < count; ++i) {
    LUXEL_TRY_STATUS(next_index(walk, mesh.vertices, "the vertex of a weight"));
  }
  return skip_to_end(walk);
}

/// The faces' material indices come before the materials that they count.
Status check_materials(Walk& walk, const MeshSize& mesh) {
  LUXEL_TRY_STATUS(next_count(walk));  // of materials; those that are there count
  LUXEL_TRY(const uint64_t faces, next_count(walk));
  if (faces != 1 || mesh.faces == 0)
    LUXEL_TRY_STATUS(check_equal(walk, faces, "material indices", mesh.faces, "faces"));
  uint64_t largest = 0;
  for (uint64_t i = 0; i < faces; ++i) {
    LUXEL_TRY(const uint64_t index, next_index(walk, UINT32_MAX, "material index"));
    largest = std::max(largest, index);
  }
  uint64_t materials = 0;
  for (;;) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    if (word == "}") break;
    materials += word == "Material" || word == "{";
    if (word != "{") LUXEL_TRY_STATUS(enter(walk));
    LUXEL_TRY_STATUS(skip_to_end(walk));
  }
  if (mesh.faces > 0 && largest >= materials)
    return walk.error("material index {} is out of range, the mesh lists {}", largest, materials);
  return {};
}

Status check_mesh(Walk& walk) {
  MeshSize mesh;
  // Vertices and faces.
  LUXEL_TRY_STATUS(enter(walk));
  LUXEL_TRY(mesh.vertices, next_count(walk));
  LUXEL_TRY_STATUS(skip_numbers(walk, 3 * mesh.vertices));
  LUXEL_TRY(mesh.faces, next_count(walk));
  LUXEL_TRY_STATUS(check_faces(walk, mesh.faces, mesh.vertices, "vertex index"));
  // The objects inside, in any order; those that are not read are skipped.
  for (;;) {
    LUXEL_TRY(const std::string_view word, next_word(walk));
    if (word == "}") return {};
    LUXEL_TRY_STATUS(enter(walk));
    Status status;
    if (word == "MeshNormals")
      status = check_normals(walk, mesh);
    else if (word == "MeshTextureCoords")
      status = check_coordinates(walk, mesh);
    else if (word == "MeshVertexColors")
      status = check_colors(walk, mesh);
    else if (word == "MeshMaterialList")
      status = check_materials(walk, mesh);
    else if (word == "SkinWeights")
      status = check_weights(walk, mesh);
    else
      status = skip_to_end(walk);
    LUXEL_TRY_STATUS(status);
  }
}

}  // namespace

Status check_x(const SourceFile& source) {
  std::string_view text(reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size());
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  // Binary and packed files, and what is no .x at all, are left to Assimp.
  if (text.size() < 12 || !text.starts_with("xof ") || text.substr(8, 4) != "txt ") return {};
  Walk walk{source, {text, std::min(text.find('\n'), text.size())}};
  int depth = 0;
  for (std::string_view word; !(word = walk.words.next()).empty();) {
    if (word == "}") {
      depth = std::max(depth - 1, 0);
    } else if (word == "Mesh") {
      LUXEL_TRY_STATUS(check_mesh(walk));
    } else {
      LUXEL_TRY_STATUS(enter(walk));
      if (word != "Frame")
        LUXEL_TRY_STATUS(skip_to_end(walk));
      else if (++depth > kDeepest)
        return walk.error("more than {} frames lie in each other", kDeepest);
    }
  }
  if (depth > 0) return walk.error("the file ends early: a frame is not closed");
  return {};
}

}  // namespace luxel::import
