// Surfaces of a .ply file, and the plain file that Assimp gets in its place.
#include "luxel/import/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "luxel/import/ply_numbers.h"

namespace luxel::import {
namespace {

/// The corners of a face, or of strips of triangles.
bool is_corners(const PlyElement& element, const PlyProperty& property) {
  return property.is_list() && (element.name == "face" || element.name == "tristrips") &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// The numbers of one element that are used.
struct Values {
  std::vector<double> single;              ///< one for each property; 0 for a list
  std::vector<double> corners, wedge_uvs;  ///< of a face or a strip
};

bool is_wedge_uvs(const PlyElement& element, const PlyProperty& property) {
  return property.is_list() && element.name == "face" && property.name == "texcoord";
}

/// Reads one number or list of what is used, or steps over it. Errors: not finite, no vertex of
/// that index. `where` is a function: a sentence is made only for the number that is wrong.
template <class Where>
Status read_property(const PlyElement& element, size_t index, bool is_used, uint64_t vertices,
                     PlyNumbers& numbers, const Where& where, Values& out) {
  const PlyProperty& property = element.properties[index];
  double count = 1, value = 0;
  if (property.is_list() && (!numbers.next(property.list_count, count) || !(count >= 0)))
    return fail(ErrorCode::bad_input, "{}: the file ends early, or a number is broken", where());
  const bool has_corners = is_corners(element, property);
  const bool is_strip = element.name == "tristrips";
  if (has_corners && count == 0 && !is_strip)
    return fail(ErrorCode::bad_input, "{}: it has no corner", where());
  std::vector<double>& list = has_corners ? out.corners : out.wedge_uvs;
  for (double i = 0; i < count; ++i) {
    if (!numbers.next(property.type, value))
      return fail(ErrorCode::bad_input, "{}: the file ends early, or a number is broken", where());
    if (!is_used) continue;
    if (!std::isfinite(value))
      return fail(ErrorCode::bad_input, "{}: {} is {}, not a finite number", where(), property.name,
                  value);
    const bool is_restart = is_strip && value == -1;
    if (has_corners && !is_restart && (value < 0 || value >= double(vertices)))
      return fail(ErrorCode::bad_input,
                  "{}: vertex index {} is out of range, there are {} vertices", where(), value,
                  vertices);
    if (property.is_list())
      list.push_back(value);
    else
      out.single[index] = value;
  }
  return {};
}

/// A property of vertices or materials that Assimp understands, and the name that it gets.
struct KnownName {
  std::string_view stated, plain;
};

constexpr KnownName kVertexNames[] = {
    {"x", "x"},          {"y", "y"},          {"z", "z"},         {"nx", "nx"},
    {"ny", "ny"},        {"nz", "nz"},        {"red", "red"},     {"green", "green"},
    {"blue", "blue"},    {"r", "red"},        {"g", "green"},     {"b", "blue"},
    {"u", "u"},          {"v", "v"},          {"s", "u"},         {"t", "v"},
    {"tx", "u"},         {"ty", "v"},         {"texture_u", "u"}, {"texture_v", "v"},
    {"texcoord_u", "u"}, {"texcoord_v", "v"},
};

constexpr KnownName kMaterialNames[] = {{"diffuse_red", "diffuse_red"},
                                        {"diffuse_green", "diffuse_green"},
                                        {"diffuse_blue", "diffuse_blue"}};

/// The single numbers of an element that are written, each plain name once.
struct KeptProperties {
  struct Kept {
    size_t index;  ///< among the element's properties
    PlyType type;
    std::string_view plain;
  };
  std::vector<Kept> kept;

  bool has(std::string_view plain) const {
    return std::any_of(kept.begin(), kept.end(), [&](const Kept& k) { return k.plain == plain; });
  }
  size_t size() const {
    size_t bytes = 0;
    for (const Kept& k : kept) bytes += size_of(k.type);
    return bytes;
  }
};

KeptProperties kept_properties(const PlyElement& element, std::span<const KnownName> known) {
  KeptProperties out;
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.is_list()) continue;
    for (const KnownName& name : known)
      if (property.name == name.stated && !out.has(name.plain))
        out.kept.push_back({i, property.type, name.plain});
  }
  return out;
}

/// Assimp would take 0 for what is missing: black colours, normals within a plane.
void drop_incomplete(std::initializer_list<std::string_view> names, KeptProperties& out) {
  if (std::all_of(names.begin(), names.end(), [&](auto name) { return out.has(name); })) return;
  std::erase_if(out.kept, [&](const KeptProperties::Kept& k) {
    return std::find(names.begin(), names.end(), k.plain) != names.end();
  });
}

bool is_coordinate(std::string_view plain) { return plain == "x" || plain == "y" || plain == "z"; }

/// `is_text`: a place may have more digits than its type says.
KeptProperties kept_of_vertex(const PlyElement& element, bool is_text) {
  KeptProperties out = kept_properties(element, kVertexNames);
  for (auto& kept : out.kept)
    if (is_text && is_coordinate(kept.plain)) kept.type = PlyType::f64;
  drop_incomplete({"nx", "ny", "nz"}, out);
  drop_incomplete({"red", "green", "blue"}, out);
  drop_incomplete({"u", "v"}, out);
  return out;
}

/// Surfaces as read from a file, before they are written.
struct Surfaces {
  KeptProperties of_vertex, of_material;
  std::string vertices, material;       ///< kept numbers, one element after the other
  std::vector<uint32_t> corner_counts;  ///< of each face
  std::vector<uint32_t> corners;
  std::vector<float> wedge_uvs;  ///< u and v of corners up to the last that has them

  size_t bytes() const {
    return vertices.capacity() +
           4 * (corner_counts.capacity() + corners.capacity() + wedge_uvs.capacity());
  }
};

/// Each triangle of strips that end at a -1; every second one is turned round.
void add_strips(std::span<const double> indices, Surfaces& out) {
  size_t begin = 0;
  for (size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] == -1) begin = i + 1;
    if (indices[i] == -1 || i < begin + 2) continue;
    const bool is_turned = (i - begin) % 2 != 0;
    out.corner_counts.push_back(3);
    for (const size_t corner : {i - 2 + is_turned, i - 1 - is_turned, i})
      out.corners.push_back(uint32_t(indices[corner]));
  }
}

void add_face(const Values& values, Surfaces& out) {
  if (values.corners.empty()) return;
  const size_t before = out.corners.size();
  out.corner_counts.push_back(uint32_t(values.corners.size()));
  for (const double corner : values.corners) out.corners.push_back(uint32_t(corner));
  if (values.wedge_uvs.size() != 2 * values.corners.size()) return;
  out.wedge_uvs.resize(2 * before);  // of faces that have none
  for (const double uv : values.wedge_uvs) out.wedge_uvs.push_back(float(uv));
}

void add_element(const PlyElement& element, const Values& values, Surfaces& out) {
  if (element.name == "vertex")
    for (const auto& kept : out.of_vertex.kept)
      append(out.vertices, values.single[kept.index], kept.type);
  if (element.name == "material" && out.material.empty())
    for (const auto& kept : out.of_material.kept)
      append(out.material, values.single[kept.index], kept.type);
  if (element.name == "face") add_face(values, out);
  if (element.name == "tristrips") add_strips(values.corners, out);
}

/// For each property whether its numbers are used.
std::vector<char> used_properties(const PlyElement& element, const Surfaces& surfaces) {
  std::vector<char> used(element.properties.size());
  for (size_t i = 0; i < used.size(); ++i)
    used[i] =
        is_corners(element, element.properties[i]) || is_wedge_uvs(element, element.properties[i]);
  if (element.name == "vertex")
    for (const auto& kept : surfaces.of_vertex.kept) used[kept.index] = true;
  if (element.name == "material")
    for (const auto& kept : surfaces.of_material.kept) used[kept.index] = true;
  return used;
}

/// White that reflects default_material()'s 0.8, unless colours or a picture say what is reflected:
/// Assimp would take white of 1.
void add_default_material(Surfaces& out) {
  out.of_material.kept.clear();
  const Rgb white = default_material().base_color;
  for (const auto& [name, value] :
       {std::pair("diffuse_red", white.x), {"diffuse_green", white.y}, {"diffuse_blue", white.z}}) {
    out.of_material.kept.push_back({0, PlyType::f32, name});
    append(out.material, value, PlyType::f32);
  }
}

/// All of the body that is one kind of element.
Status read_elements(const SourceFile& source, const PlyElement& element, uint64_t vertices,
                     PlyNumbers& numbers, Surfaces& out) {
  // Nothing to read is nothing that a wrong count would run into.
  if (element.properties.empty() && element.count > source.bytes.size())
    return fail(ErrorCode::bad_input, "{}: {} entries of the element {} have no properties",
                source.name, element.count, element.name);
  const std::vector<char> used = used_properties(element, out);
  uint64_t taken = out.bytes();
  Values values;
  for (uint64_t i = 0; i < element.count; ++i) {
    const auto where = [&] { return fmt::format("{}: {} {}", source.name, element.name, i); };
    if (!numbers.begin_element())
      return fail(ErrorCode::bad_input, "{}: the file ends early", where());
    values.single.assign(used.size(), 0);
    values.corners.clear();
    values.wedge_uvs.clear();
    for (size_t p = 0; p < used.size(); ++p)
      LUXEL_TRY_STATUS(read_property(element, p, used[p], vertices, numbers, where, values));
    add_element(element, values, out);
    if (out.bytes() <= taken) continue;
    LUXEL_TRY_STATUS(source.memory.take(out.bytes() - taken, "the numbers of " + source.name));
    taken = out.bytes();
  }
  return {};
}

Result<Surfaces> read_surfaces(const SourceFile& source, const PlyHeader& header,
                               std::vector<std::string>& warnings) {
  Surfaces out;
  uint64_t vertices = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") vertices = element.count;
    if (element.name == "vertex")
      out.of_vertex = kept_of_vertex(element, header.format == PlyHeader::Format::ascii);
    if (element.name == "material") out.of_material = kept_properties(element, kMaterialNames);
    if (element.name == "material" && element.count > 1)
      warnings.push_back(
          fmt::format("{}: all faces get the first of {} materials", source.name, element.count));
  }
  PlyNumbers numbers{header.format, header.body};
  for (const PlyElement& element : header.elements)
    LUXEL_TRY_STATUS(read_elements(source, element, vertices, numbers, out));
  if (vertices > UINT32_MAX || out.corners.size() > UINT32_MAX)
    return fail(ErrorCode::unsupported, "{}: there are more than {} vertices or corners",
                source.name, UINT32_MAX);
  if (out.material.empty() && !out.of_vertex.has("red") && header.texture_file.empty())
    add_default_material(out);
  return out;
}

/// Brings vertices that lie far from the file's origin near another one, which it returns. Those in
/// single precision lose nothing where they are.
DVec3 take_origin_off(Surfaces& surfaces) {
  std::array<size_t, 3> at{SIZE_MAX, SIZE_MAX, SIZE_MAX};  // of x, y and z in a vertex
  size_t size = 0;
  for (const auto& kept : surfaces.of_vertex.kept) {
    if (kept.type == PlyType::f64 && is_coordinate(kept.plain))
      at[size_t(kept.plain[0] - 'x')] = size;
    size += size_of(kept.type);
  }
  if (std::ranges::count(at, SIZE_MAX) > 0) return {};
  const auto number = [&](size_t vertex, size_t axis) {
    double out = 0;
    std::memcpy(&out, surfaces.vertices.data() + vertex * size + at[axis], sizeof out);
    return out;
  };
  DBox3 box;
  for (const uint32_t v : surfaces.corners) box.extend({number(v, 0), number(v, 1), number(v, 2)});
  const DVec3 origin = origin_for(box);
  if (origin == DVec3{}) return origin;
  for (size_t v = 0; v < surfaces.vertices.size() / size; ++v)
    for (size_t axis = 0; axis < 3; ++axis) {
      const double moved = number(v, axis) - std::array{origin.x, origin.y, origin.z}[axis];
      std::memcpy(surfaces.vertices.data() + v * size + at[axis], &moved, sizeof moved);
    }
  return origin;
}

std::string_view name_of(PlyType type) {
  constexpr std::string_view kNames[] = {"",    "char", "uchar", "short", "ushort",
                                         "int", "uint", "float", "double"};
  return kNames[size_t(type)];
}

/// Every corner gets a vertex of its own, with its u and v.
void split_wedges(Surfaces& surfaces) {
  const size_t size = surfaces.of_vertex.size();
  surfaces.wedge_uvs.resize(2 * surfaces.corners.size());
  std::string vertices;
  vertices.reserve((size + 8) * surfaces.corners.size());
  for (size_t i = 0; i < surfaces.corners.size(); ++i) {
    vertices.append(surfaces.vertices, surfaces.corners[i] * size, size);
    append(vertices, surfaces.wedge_uvs[2 * i], PlyType::f32);
    append(vertices, surfaces.wedge_uvs[2 * i + 1], PlyType::f32);
    surfaces.corners[i] = uint32_t(i);
  }
  surfaces.vertices = std::move(vertices);
  surfaces.of_vertex.kept.push_back({0, PlyType::f32, "u"});  // Assimp takes the last
  surfaces.of_vertex.kept.push_back({0, PlyType::f32, "v"});
}

/// Assimp would take the line of some names for another line of the header.
bool can_be_named(std::string_view texture_file) {
  for (const char* word : {"comment", "element", "end_header", "property"})
    if (texture_file.starts_with(word)) return false;
  return std::none_of(texture_file.begin(), texture_file.end(),
                      [](char c) { return uint8_t(c) < ' '; });
}

std::string header_text(const PlyHeader& header, const Surfaces& surfaces) {
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  if (!header.texture_file.empty() && can_be_named(header.texture_file))
    out += fmt::format("comment TextureFile {}\n", header.texture_file);
  const auto add_element = [&](std::string_view name, size_t count, const KeptProperties& has) {
    if (has.kept.empty()) return;
    out += fmt::format("element {} {}\n", name, count);
    for (const auto& kept : has.kept)
      out += fmt::format("property {} {}\n", name_of(kept.type), kept.plain);
  };
  // Assimp takes line ends that follow for those of the header, so that something else must.
  out += "element edge 1\nproperty uchar nothing\n";
  const size_t vertices = surfaces.vertices.size() / std::max<size_t>(1, surfaces.of_vertex.size());
  add_element("vertex", vertices, surfaces.of_vertex);
  if (!surfaces.material.empty()) add_element("material", 1, surfaces.of_material);
  out += fmt::format("element face {}\nproperty list uint uint vertex_indices\nend_header\n",
                     surfaces.corner_counts.size());
  return out;
}

std::string ply_text(const PlyHeader& header, const Surfaces& surfaces) {
  std::string out = header_text(header, surfaces);
  out.reserve(out.size() + surfaces.vertices.size() + surfaces.material.size() +
              4 * (surfaces.corner_counts.size() + surfaces.corners.size()));
  out += '\0';
  out += surfaces.vertices;
  out += surfaces.material;
  size_t corner = 0;
  for (const uint32_t count : surfaces.corner_counts) {
    append(out, count, PlyType::u32);
    for (uint32_t i = 0; i < count; ++i) append(out, surfaces.corners[corner++], PlyType::u32);
  }
  return out;
}

}  // namespace

Result<PlainPly> write_plain_ply(const SourceFile& source, std::vector<std::string>& warnings) {
  LUXEL_TRY(const PlyHeader header, read_ply_header(source));
  LUXEL_TRY(Surfaces surfaces, read_surfaces(source, header, warnings));
  if (surfaces.corner_counts.empty())
    return fail(ErrorCode::bad_input, "{}: it has points but no faces; nothing can be lit",
                source.name);
  PlainPly plain;
  plain.near = take_origin_off(surfaces);
  const std::string what = "the vertices of " + source.name;
  if (!surfaces.wedge_uvs.empty()) {
    LUXEL_TRY_STATUS(
        source.memory.take((surfaces.of_vertex.size() + 16) * surfaces.corners.size(), what));
    split_wedges(surfaces);
  }
  LUXEL_TRY_STATUS(source.memory.take(surfaces.bytes(), what));
  plain.text = ply_text(header, surfaces);
  for (const auto& kept : surfaces.of_vertex.kept)
    plain.has_display_colors |= kept.plain == "red" && kept.type == PlyType::u8;
  return plain;
}

}  // namespace luxel::import
