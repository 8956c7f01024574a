// The primitives of a glTF mesh become one scene::Mesh.
#include <map>

#include "luxel/import/gltf_pose.h"

namespace luxel::import {
namespace {

using Triangle = std::array<uint32_t, 3>;
/// Attributes of a primitive, those of its morph targets, and its material's GltfReader::first_set.
using Sources = std::tuple<Attributes, std::vector<Attributes>, int>;

std::vector<Vec2> to_vec2(const Numbers& numbers) {
  std::vector<Vec2> values(numbers.count());
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = {numbers.values[2 * i], numbers.values[2 * i + 1]};
  return values;
}

Result<Vertices> read_vertices(const GltfReader& reader, const Attributes& attributes,
                               int first_set, bool with_alphas, const std::string& where) {
  Vertices v;
  LUXEL_TRY(const Numbers positions,
            read_numbers(reader.model, attributes.at("POSITION"), {3}, where + ", POSITION"));
  v.positions = to_vec3(positions);
  const size_t n = v.positions.size();
  LUXEL_TRY(const Numbers normals, read_attribute(reader, attributes, "NORMAL", {3}, n, where));
  const std::string first = fmt::format("TEXCOORD_{}", first_set);
  LUXEL_TRY(const Numbers uv0, read_attribute(reader, attributes, first.c_str(), {2}, n, where));
  LUXEL_TRY(const Numbers uv1, read_attribute(reader, attributes, "TEXCOORD_1", {2}, n, where));
  LUXEL_TRY(const Numbers colors, read_attribute(reader, attributes, "COLOR_0", {3, 4}, n, where));
  v.normals = to_vec3(normals);
  v.uv0 = to_vec2(uv0);
  v.uv1 = to_vec2(uv1);
  v.colors = to_vec3(colors);
  if (with_alphas && colors.components == 4)
    for (size_t i = 3; i < colors.values.size(); i += 4) v.alphas.push_back(colors.values[i]);
  return v;
}

/// The triangles that a list of vertex indices stands for. [glTF 2.0, section 3.7.2.1]
std::vector<Triangle> triangles_of(int mode, const std::vector<uint32_t>& index) {
  std::vector<Triangle> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES)
    for (size_t i = 0; i + 2 < index.size(); i += 3)
      triangles.push_back({index[i], index[i + 1], index[i + 2]});
  // Every second triangle of a strip would be seen from behind: its last two corners are swapped.
  if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
    for (size_t i = 0; i + 2 < index.size(); ++i)
      triangles.push_back({index[i], index[i + 1 + i % 2], index[i + 2 - i % 2]});
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
    for (size_t i = 1; i + 1 < index.size(); ++i)
      triangles.push_back({index[i], index[i + 1], index[0]});
  return triangles;
}

Result<std::vector<Triangle>> read_triangles(const GltfReader& reader,
                                             const tinygltf::Primitive& primitive, size_t vertices,
                                             const std::string& where) {
  std::vector<uint32_t> index;
  if (primitive.indices >= 0) {
    LUXEL_TRY(index, read_indices(reader.model, primitive.indices, where));
  } else {
    index.resize(vertices);
    for (size_t i = 0; i < vertices; ++i) index[i] = uint32_t(i);
  }
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES && index.size() % 3 != 0)
    return fail(ErrorCode::bad_input, "{} has {} indices, not a multiple of 3", where,
                index.size());
  for (const uint32_t i : index)
    if (i >= vertices)
      return fail(ErrorCode::bad_input,
                  "{}: vertex index {} is out of range, there are {} vertices", where, i, vertices);
  return triangles_of(primitive.mode, index);
}

/// Gives every triangle corners of its own with the triangle's normal: how a primitive without
/// normals looks [glTF 2.0, section 3.7.2.1], said in vertices because the mesh has normals.
void make_flat(Vertices& v, std::vector<Triangle>& triangles) {
  Vertices flat;
  const auto copy = [](const auto& from, auto& to, uint32_t corner) {
    if (!from.empty()) to.push_back(from[corner]);
  };
  for (Triangle& t : triangles) {
    const auto [a, b, c] = t;
    const Vec3 n =
        normalize(scene::geometric_normal_area2({v.positions[a], v.positions[b], v.positions[c]}));
    for (uint32_t& corner : t) {
      copy(v.positions, flat.positions, corner);
      copy(v.uv0, flat.uv0, corner);
      copy(v.uv1, flat.uv1, corner);
      copy(v.colors, flat.colors, corner);
      copy(v.alphas, flat.alphas, corner);
      flat.normals.push_back(n);
      corner = uint32_t(flat.positions.size() - 1);
    }
  }
  v = std::move(flat);
}

/// Appends values for the vertices from `start` on. An attribute that only some primitives have is
/// filled up for the others, at once or when it first turns up.
template <class T>
void append(std::vector<T>& to, const std::vector<T>& values, size_t start, size_t count, T filling,
            bool& filled) {
  if (to.empty() && values.empty()) return;
  filled |= values.empty() || to.size() < start;
  to.resize(start, filling);
  if (values.empty())
    to.resize(start + count, filling);
  else
    to.insert(to.end(), values.begin(), values.end());
}

/// Returns whether texture coordinates had to be made up.
bool append_vertices(scene::Mesh& mesh, const Vertices& v) {
  const size_t start = mesh.positions.size(), count = v.positions.size();
  bool uv_filled = false, ignored = false;
  append(mesh.normals, v.normals, start, count, Vec3{}, ignored);
  append(mesh.uv0, v.uv0, start, count, Vec2{}, uv_filled);
  append(mesh.uv1, v.uv1, start, count, Vec2{}, uv_filled);
  append(mesh.colors, v.colors, start, count, Rgb{1, 1, 1}, ignored);
  append(mesh.alphas, v.alphas, start, count, 1.0f, ignored);
  mesh.positions.insert(mesh.positions.end(), v.positions.begin(), v.positions.end());
  return uv_filled;
}

uint32_t material_of(GltfReader& reader, const tinygltf::Primitive& primitive) {
  if (primitive.material >= 0) return uint32_t(primitive.material);
  std::vector<scene::Material>& materials = reader.out.scene.materials;
  if (reader.default_material == scene::kNone) {
    reader.default_material = uint32_t(materials.size());
    materials.push_back(default_material());
  }
  return reader.default_material;
}

/// True where the primitive is drawn; else a warning says why not.
bool has_surface(GltfReader& reader, const tinygltf::Primitive& primitive,
                 const std::string& where) {
  if (primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode <= TINYGLTF_MODE_LINE_STRIP) {
    reader.out.warnings.push_back(where + " is made of points or lines and is skipped");
    return false;
  }
  if (primitive.mode < 0 || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    reader.out.warnings.push_back(where +
                                  fmt::format(" has mode {} and is skipped", primitive.mode));
    return false;
  }
  if (primitive.attributes.count("POSITION") == 0) {
    reader.out.warnings.push_back(where + " has no positions and is skipped");
    return false;
  }
  return true;
}

/// Vertices of the mesh that a primitive brought.
struct Taken {
  uint32_t start = 0, count = 0;
  std::vector<bool> mirrored;
};

struct MeshBuilder {
  GltfReader& reader;
  const Pose& pose;
  scene::Mesh mesh;
  bool some_normals = false;
  bool some_alphas = false;  ///< a material counts them
  bool uv_filled = false;
  std::map<Sources, Taken> taken;  ///< primitives often share all their vertices
};

void turn_mirrored(const std::vector<bool>& mirrored, std::vector<Triangle>& triangles) {
  if (mirrored.empty()) return;
  for (Triangle& t : triangles)
    if (mirrored[t[0]]) std::swap(t[1], t[2]);
}

Status add_primitive(MeshBuilder& builder, const tinygltf::Primitive& primitive,
                     const std::string& where) {
  scene::Mesh& mesh = builder.mesh;
  uint32_t start = uint32_t(mesh.positions.size());
  std::vector<Triangle> triangles;
  const int first_set =
      primitive.material < 0 ? 0 : builder.reader.first_set[size_t(primitive.material)];
  const Sources sources{primitive.attributes, primitive.targets, first_set};
  const auto known = builder.taken.find(sources);
  if (known != builder.taken.end()) {
    start = known->second.start;
    LUXEL_TRY(triangles, read_triangles(builder.reader, primitive, known->second.count, where));
    turn_mirrored(known->second.mirrored, triangles);
  } else {
    LUXEL_TRY(Vertices v, read_vertices(builder.reader, primitive.attributes, first_set,
                                        builder.some_alphas, where));
    LUXEL_TRY_STATUS(apply_pose(builder.reader, primitive, builder.pose, where, v));
    const size_t count = v.positions.size();
    if (mesh.positions.size() + 3 * count > UINT32_MAX)
      return fail(ErrorCode::unsupported, "{}: the mesh has over 4 billion vertices", where);
    LUXEL_TRY(triangles, read_triangles(builder.reader, primitive, count, where));
    turn_mirrored(v.mirrored, triangles);
    if (builder.some_normals && v.normals.empty())
      make_flat(v, triangles);
    else
      builder.taken[sources] = {start, uint32_t(count), std::move(v.mirrored)};
    builder.uv_filled |= append_vertices(mesh, v);
  }
  const uint32_t material = material_of(builder.reader, primitive);
  for (Triangle& t : triangles) {
    for (uint32_t& corner : t) corner += start;
    mesh.triangles.push_back(t);
    mesh.triangle_material.push_back(material);
  }
  return {};
}

Result<scene::Mesh> read_mesh(GltfReader& reader, size_t index, const Pose& pose) {
  const tinygltf::Mesh& in = reader.model.meshes[index];
  const std::string name = reader.source.name + ": " + label("mesh", index, in.name);
  MeshBuilder builder{reader, pose, {}, false, false, false, {}};
  builder.mesh.name = in.name;
  bool unindexed = false;
  for (const tinygltf::Primitive& p : in.primitives) {
    builder.some_normals |= p.attributes.count("NORMAL") > 0;
    builder.some_alphas |= p.material >= 0 && counts_alpha(reader.out.scene, uint32_t(p.material));
  }
  for (size_t i = 0; i < in.primitives.size(); ++i) {
    const tinygltf::Primitive& primitive = in.primitives[i];
    const std::string where = name + fmt::format(", primitive {}", i);
    if (!has_surface(reader, primitive, where)) continue;
    unindexed |= primitive.indices < 0;
    LUXEL_TRY_STATUS(add_primitive(builder, primitive, where));
  }
  if (builder.uv_filled)
    reader.out.warnings.push_back(
        name + ": only some primitives have texture coordinates; (0, 0) is used for the others");
  drop_alphas_of_one(builder.mesh);
  // Without indices nothing says which triangles are neighbours, and charts need to know.
  if (unindexed) join_identical_vertices(builder.mesh);
  return std::move(builder.mesh);
}

}  // namespace

Status read_meshes(GltfReader& reader) {
  const tinygltf::Model& model = reader.model;
  std::vector<bool> is_posed(model.meshes.size()), is_plain(model.meshes.size());
  for (const tinygltf::Node& node : model.nodes)
    if (node.mesh >= 0) (has_own_pose(model, node) ? is_posed : is_plain)[size_t(node.mesh)] = true;
  for (size_t i = 0; i < model.meshes.size(); ++i) {
    reader.out.scene.meshes.emplace_back();
    if (is_posed[i] && !is_plain[i]) continue;
    LUXEL_TRY(reader.out.scene.meshes.back(),
              read_mesh(reader, i, Pose{model.meshes[i].weights, {}, {}}));
  }
  return {};
}

Result<scene::Mesh> posed_mesh(GltfReader& reader, size_t number) {
  const tinygltf::Node& node = reader.model.nodes[number];
  const auto index = size_t(node.mesh);
  const std::string where = reader.source.name + ": " + label("node", number, node.name);
  // Nodes may pose one mesh again and again.
  uint64_t vertices = 0, corners = 0;
  for (const tinygltf::Primitive& p : reader.model.meshes[index].primitives) {
    const auto count_of = [&](int accessor) {
      return accessor < 0 ? 0 : uint64_t(reader.model.accessors[size_t(accessor)].count);
    };
    const auto positions = p.attributes.find("POSITION");
    const uint64_t own = positions == p.attributes.end() ? 0 : count_of(positions->second);
    vertices += own, corners += p.indices < 0 ? own : count_of(p.indices);
  }
  LUXEL_TRY_STATUS(reader.source.memory.take(64 * vertices + 16 * corners, "the pose of " + where));
  LUXEL_TRY(const Pose pose, pose_of(reader, number));
  return read_mesh(reader, index, pose);
}

}  // namespace luxel::import
