// .obj files and their materials, through tinyobjloader.
#include <tiny_obj_loader.h>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <unordered_map>

#include "luxel/base/vec2_double.h"
#include "luxel/import/obj_text.h"
#include "luxel/import/pictures.h"
#include "luxel/import/polygon.h"
#include "luxel/scene/smooth_normals.h"

namespace luxel::import {
namespace {

static_assert(std::is_same_v<tinyobj::real_t, double>, "coordinates may lie far from the origin");

/// A place in each list, from 1 on; 0: none.
using Corner = std::array<uint32_t, 3>;

struct Face {
  size_t first = 0;  ///< of its corners
  uint32_t count = 0, state = 0;
};

/// The lists that tinyobjloader hands out, line by line.
struct Found {
  std::vector<DVec3> positions, normals;
  std::vector<DVec2> uvs;
  std::vector<Corner> corners;
  std::vector<Face> faces;
  uint32_t state = 0;
};

Found& found_of(void* user_data) { return *static_cast<Found*>(user_data); }

tinyobj::callback_t callbacks() {
  tinyobj::callback_t out;
  out.vertex_cb = [](void* user, double x, double y, double z, double) {
    found_of(user).positions.push_back({x, y, z});
  };
  out.normal_cb = [](void* user, double x, double y, double z) {
    found_of(user).normals.push_back({x, y, z});
  };
  out.texcoord_cb = [](void* user, double x, double y, double) {
    found_of(user).uvs.push_back({x, y});
  };
  out.index_cb = [](void* user, tinyobj::index_t* indices, int count) {
    Found& found = found_of(user);
    found.faces.push_back({found.corners.size(), uint32_t(count), found.state});
    for (int k = 0; k < count; ++k)
      found.corners.push_back({uint32_t(indices[k].vertex_index),
                               uint32_t(indices[k].texcoord_index),
                               uint32_t(indices[k].normal_index)});
  };
  out.group_cb = [](void* user, const char** names, int count) {
    if (count > 0) found_of(user).state = uint32_t(std::strtoul(names[0], nullptr, 10));
  };
  return out;
}

Found read_text(ObjText& in) {
  Found found;
  found.positions.reserve(size_t(in.counts.v)), found.normals.reserve(size_t(in.counts.vn));
  found.uvs.reserve(size_t(in.counts.vt)), found.corners.reserve(size_t(in.counts.corners));
  found.faces.reserve(size_t(in.counts.faces));
  std::istringstream text(std::move(in.text));
  tinyobj::LoadObjWithCallback(text, callbacks(), &found);
  LUXEL_CHECK(found.positions.size() == in.counts.v && found.uvs.size() == in.counts.vt &&
              found.normals.size() == in.counts.vn && found.faces.size() == in.counts.faces &&
              found.corners.size() == in.counts.corners);
  return found;
}

/// Brings vertices that lie far from the file's origin near another one, which it returns.
DVec3 take_origin_off(Found& found) {
  DBox3 box;
  for (const Corner& corner : found.corners) box.extend(found.positions[corner[0] - 1]);
  const DVec3 origin = origin_for(box);
  for (DVec3& p : found.positions) p = p - origin;
  return origin;
}

// Materials.

struct Reading {
  const SourceFile& source;
  const ObjText& in;
  Imported& out;
  Pictures pictures;
  std::map<uint32_t, uint32_t> materials{};  ///< of the scene, by number in the file
};

Result<scene::TextureRef> texture_of(Reading& reading, const MtlPicture& picture,
                                     const std::string& user, std::string_view instead) {
  scene::TextureRef ref;
  if (picture.name.empty()) return ref;
  const auto load = [&] { return load_picture(reading.source, picture.name, user); };
  LUXEL_TRY(ref.texture, picture_of(reading.pictures, picture.name, instead, load));
  if (picture.clamp) ref.wrap_u = ref.wrap_v = scene::Wrap::clamp;
  // The scene's v grows downwards: 1 - (s v + o) = s (1 - v) + (1 - s - o).
  ref.scale = picture.scale;
  ref.offset = {picture.offset.x, 1 - picture.scale.y - picture.offset.y};
  return ref;
}

/// A material that no library has is white.
Result<scene::Material> read_material(Reading& reading, const std::string& name, size_t number) {
  scene::Material out = default_material();
  if (name.empty()) return out;
  out.name = name;
  const auto found = reading.in.library.find(name);
  if (found == reading.in.library.end()) return out;
  const MtlMaterial& in = found->second;
  const std::string user = label("material", number, name);
  out.specular = in.specular, out.sharpness = in.sharpness;
  out.emission = in.emission, out.metallic = in.metallic, out.alpha = in.alpha;
  if (out.alpha < 1) out.alpha_mode = scene::AlphaMode::blend;
  LUXEL_TRY(out.base_color_texture, texture_of(reading, in.color_picture, user, kColorInstead));
  LUXEL_TRY(out.emission_texture, texture_of(reading, in.emission_picture, user, kNoGlow));
  // A picture alone means the picture as it is.
  if (in.color)
    out.base_color = *in.color;
  else if (out.base_color_texture.texture != scene::kNone)
    out.base_color = {1, 1, 1};
  const bool glows = out.emission_texture.texture != scene::kNone;
  if (glows && max_component(out.emission) <= 0) out.emission = {1, 1, 1};
  if (!glows && !in.emission_picture.name.empty()) out.emission = {};  // where is not known
  return out;
}

/// The materials that faces have, in the order of their first face.
Status read_materials(const Found& found, Reading& reading) {
  for (const Face& face : found.faces) {
    const uint32_t number = reading.in.states[face.state].material;
    std::vector<scene::Material>& materials = reading.out.scene.materials;
    const auto [at, is_new] = reading.materials.try_emplace(number, uint32_t(materials.size()));
    if (!is_new) continue;
    LUXEL_TRY(scene::Material material,
              read_material(reading, reading.in.materials[number], materials.size()));
    materials.push_back(std::move(material));
  }
  return {};
}

// Surfaces.

struct CornerHash {
  size_t operator()(const Corner& c) const {
    return (size_t(c[0]) * 0x9E3779B97F4A7C15u ^ size_t(c[1]) * 0xC2B2AE3D27D4EB4Fu) +
           size_t(c[2]) * 0x165667B19E3779F9u;
  }
};

/// A group in the making.
struct Part {
  scene::Mesh mesh;
  std::unordered_map<Corner, uint32_t, CornerHash> vertex;
  std::vector<uint32_t> smoothing;  ///< of each triangle
  bool has_normals = false, has_uv = false;
};

/// Faces of four corners or more that do not lie in one plane, and polygons that cross themselves.
struct OddFaces {
  size_t bent = 0, first_bent_line = 0, crossing = 0, first_crossing_line = 0;
  std::set<std::string> bent_groups;
};

/// True when a corner lies further from the plane of the others than a 100,000th of the face's
/// size.
bool is_bent(std::span<const DVec3> at) {
  DVec3 twice_area;
  double size = 0, magnitude = 0;
  for (size_t k = 0; k < at.size(); ++k) {
    const DVec3 r = at[k] - at[0];
    size = std::max(size, length(r));
    magnitude = std::max({magnitude, std::abs(at[k].x), std::abs(at[k].y), std::abs(at[k].z)});
    if (k >= 2) twice_area += cross(at[k - 1] - at[0], r);
  }
  const DVec3 normal = normalize(twice_area);
  double lowest = 0, highest = 0;
  for (const DVec3& p : at) {
    const double height = dot(normal, p - at[0]);
    lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
  return highest - lowest > 1e-5 * size + 1e-6 * magnitude;  // numbers are printed with six digits
}

uint32_t vertex_of(const Corner& corner, const Found& found, const ObjText& in, Part& part) {
  scene::Mesh& mesh = part.mesh;
  const auto [at, is_new] = part.vertex.try_emplace(corner, uint32_t(mesh.positions.size()));
  if (!is_new) return at->second;
  mesh.positions.push_back(to_float(found.positions[corner[0] - 1]));
  // A zero normal is later replaced by that of the triangles around it.
  mesh.normals.push_back(corner[2] == 0 ? Vec3{} : to_float(found.normals[corner[2] - 1]));
  const DVec2 uv = corner[1] == 0 ? DVec2{} : found.uvs[corner[1] - 1];
  mesh.uv0.push_back(corner[1] == 0 ? Vec2{} : Vec2{float(uv.x), float(1 - uv.y)});
  if (!in.colors.empty()) mesh.colors.push_back(in.colors[corner[0] - 1]);
  part.has_normals |= corner[2] != 0, part.has_uv |= corner[1] != 0;
  return at->second;
}

void append_face(const Found& found, size_t number, uint32_t material, const ObjText& in,
                 Part& part, OddFaces& odd) {
  const Face& face = found.faces[number];
  const std::span<const Corner> corners(found.corners.data() + face.first, face.count);
  std::vector<DVec3> at;
  for (const Corner& corner : corners) at.push_back(found.positions[corner[0] - 1]);
  if (at.size() > 3 && is_bent(at)) {
    if (odd.bent++ == 0) odd.first_bent_line = in.lines[number];
    odd.bent_groups.insert(in.groups[in.states[face.state].group]);
  }
  std::vector<std::array<uint32_t, 3>> triangles;
  if (!triangulate(at, triangles) && odd.crossing++ == 0)
    odd.first_crossing_line = in.lines[number];
  for (const auto& [a, b, c] : triangles) {
    const auto vertex = [&](uint32_t k) { return vertex_of(corners[k], found, in, part); };
    const uint32_t first = vertex(a), second = vertex(b), third = vertex(c);
    part.mesh.triangles.push_back({first, second, third});
    part.mesh.triangle_material.push_back(material);
    part.smoothing.push_back(in.states[face.state].smoothing);
  }
}

/// One mesh and one instance of each group that has faces, in the order of the file.
void append_groups(const Found& found, Reading& reading, OddFaces& odd) {
  const ObjText& in = reading.in;
  std::vector<Part> parts(in.groups.size());
  for (size_t f = 0; f < found.faces.size(); ++f) {
    const ObjState& state = in.states[found.faces[f].state];
    append_face(found, f, reading.materials.at(state.material), in, parts[state.group], odd);
  }
  scene::Scene& scene = reading.out.scene;
  for (size_t g = 0; g < parts.size(); ++g) {
    scene::Mesh& mesh = parts[g].mesh;
    if (mesh.triangles.empty()) continue;
    if (!parts[g].has_normals) mesh.normals.clear();
    if (!parts[g].has_uv) mesh.uv0.clear();
    join_identical_vertices(mesh);
    if (reading.out.is_smoothed) scene::smooth_normals(mesh, parts[g].smoothing);
    mesh.name = in.groups[g].empty() ? reading.source.path.stem().string() : in.groups[g];
    scene.instances.push_back(
        {mesh.name, uint32_t(scene.meshes.size()), reading.source.world_from_file});
    scene.meshes.push_back(std::move(mesh));
    parts[g] = {};
  }
}

void warn_of(const OddFaces& odd, const SourceFile& source, std::vector<std::string>& warnings) {
  constexpr size_t kMostNames = 5;
  if (odd.crossing > 0)
    warnings.push_back(fmt::format(
        "{}: polygons whose outline crosses itself: {}, the first in line {}; their area is not "
        "right; mend them in your modeller",
        source.name, odd.crossing, odd.first_crossing_line));
  if (odd.bent == 0) return;
  std::string groups;
  size_t listed = 0;
  for (const std::string& group : odd.bent_groups) {
    if (listed++ == kMostNames) break;
    groups += fmt::format("{}'{}'", listed == 1 ? "" : ", ", group);
  }
  if (odd.bent_groups.size() > kMostNames)
    groups += fmt::format(" and {} more", odd.bent_groups.size() - kMostNames);
  warnings.push_back(fmt::format(
      "{}: {} whose corners do not lie in one plane {} split into triangles, the first in line {}; "
      "in {}",
      source.name, odd.bent == 1 ? "1 face" : fmt::format("{} faces", odd.bent),
      odd.bent == 1 ? "is" : "are", odd.first_bent_line, groups));
}

}  // namespace

Result<Imported> read_obj(const SourceFile& source, ExactPlaces& exact) {
  Imported out;
  LUXEL_TRY(ObjText in, plain_obj(source, out.warnings));
  Found found = read_text(in);
  const DVec3 near = take_origin_off(found);
  Reading reading{source, in, out, {source, out}};
  LUXEL_TRY_STATUS(read_materials(found, reading));
  out.is_smoothed = in.states_smoothing && source.smooths_by_groups;
  OddFaces odd;
  append_groups(found, reading, odd);
  warn_of(odd, source, out.warnings);
  exact.instances.assign(out.scene.instances.size(),
                         as_stated(source.world_from_file) * moved_by(near));
  exact.is_relative = near != DVec3{};
  out.about_lost_lights =
      "an .obj file can hold no lights except emissive materials (Ke in its .mtl)";
  return out;
}

}  // namespace luxel::import
