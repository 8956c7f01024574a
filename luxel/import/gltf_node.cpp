// The nodes of the default scene: instances, lights, cameras, each with its place in the world.
#include <map>

#include "luxel/import/gltf_pose.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::import {
namespace {

/// A rotation by a quaternion (x, y, z, w), which files store only nearly of unit length.
DMat34 rotation(double x, double y, double z, double w) {
  const double length2 = x * x + y * y + z * z + w * w;
  if (!(length2 > 0)) return {};
  const double s = 2 / length2;
  return {{{{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0},
            {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0},
            {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0}}}};
}

Mat34 rounded(const DMat34& m) {
  Mat34 out;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 4; ++j) out.row[i][j] = float(m.row[i][j]);
  return out;
}

/// A node's own map, in both precisions: their products round in other places.
std::pair<Mat34, DMat34> local_transforms(const tinygltf::Node& node) {
  DMat34 exact;
  if (node.matrix.size() == 16) {  // column by column
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 4; ++j) exact.row[i][j] = node.matrix[4 * j + i];
    return {rounded(exact), exact};
  }
  const std::vector<double>&q = node.rotation, &t = node.translation, &s = node.scale;
  if (q.size() == 4) exact = rotation(q[0], q[1], q[2], q[3]);
  const Mat34 local = translation(vec3_of(t, {})) * rounded(exact) * scaling(vec3_of(s, {1, 1, 1}));
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3 && s.size() == 3; ++j) exact.row[i][j] *= s[j];
    if (t.size() == 3) exact.row[i][3] = t[i];
  }
  return {local, exact};
}

/// The value that extras give as "luxel": {"KEY": ...} or as "FLAT_KEY"; null where they do not.
const tinygltf::Value* luxel_extra(const tinygltf::Value& extras, const char* key,
                                   const char* flat_key) {
  if (!extras.IsObject()) return nullptr;
  if (extras.Has(flat_key)) return &extras.Get(flat_key);
  if (!extras.Has("luxel") || !extras.Get("luxel").IsObject()) return nullptr;
  return extras.Get("luxel").Has(key) ? &extras.Get("luxel").Get(key) : nullptr;
}

/// Half the angle of a sun's disc, of which glTF has no word.
float disc_of(const tinygltf::Light& light) {
  const tinygltf::Value* v =
      luxel_extra(light.extras, "angular_radius_rad", "luxel_angular_radius_rad");
  const double radius = v && v->IsNumber() ? v->GetNumberAsDouble() : 0;
  return radius > 0 && radius <= double(kPi) / 2 ? float(radius) : 0.0f;
}

/// [KHR_lights_punctual]: a light shines along its node's -z; scale does not change it.
void add_light(GltfReader& reader, size_t number) {
  const tinygltf::Node& node = reader.model.nodes[number];
  const Mat34& world = reader.world.rounded[number];
  const auto extension = node.extensions.find("KHR_lights_punctual");
  if (extension == node.extensions.end()) return;
  const double index = number_in(extension->second, "light", -1);
  if (index < 0 || index >= double(reader.model.lights.size())) return;
  const tinygltf::Light& in = reader.model.lights[size_t(index)];
  const std::optional<scene::LightKind> kind = scene::kind_named(in.type);
  if (!kind) {
    reader.warn("{} has the unknown type '{}' and is skipped",
                label("light", size_t(index), in.name), in.type);
    return;
  }
  scene::PunctualLight light;
  light.name = node.name.empty() ? in.name : node.name;
  light.kind = *kind;
  light.intensity = vec3_of(in.color, {1, 1, 1}) * float(in.intensity);
  light.position = transform_point(world, {});
  light.direction = normalize(-column(world, 2));
  light.side = normalize(column(world, 0));
  light.range_m = float(in.range);
  light.inner_cone_rad = float(in.spot.innerConeAngle);
  light.outer_cone_rad = float(in.spot.outerConeAngle);
  if (!scene::has_position(light.kind)) light.angular_radius_rad = disc_of(in);
  reader.out.scene.lights.push_back(light);
  reader.out.node_of_light.push_back(uint32_t(number));
  reader.exact.lights.push_back(translation_of(reader.world.exact[number]));
}

void add_camera(GltfReader& reader, size_t number) {
  const tinygltf::Node& node = reader.model.nodes[number];
  if (node.camera < 0) return;
  const Mat34& world = reader.world.rounded[number];
  const tinygltf::Camera& in = reader.model.cameras[size_t(node.camera)];
  scene::Camera camera;
  camera.name = !node.name.empty() ? node.name : in.name;
  camera.world_from_camera = from_columns(normalize(column(world, 0)), normalize(column(world, 1)),
                                          normalize(column(world, 2)), transform_point(world, {}));
  if (in.type == "orthographic") {
    camera.orthographic_height_m = 2 * float(in.orthographic.ymag);  // ymag is half of it
    camera.aspect =
        in.orthographic.ymag > 0 ? float(in.orthographic.xmag / in.orthographic.ymag) : 0.0f;
    camera.fov_y_rad = 0;  // so that a height of 0 leaves no view
  } else {
    camera.fov_y_rad = float(in.perspective.yfov);
    camera.aspect = float(in.perspective.aspectRatio);
  }
  reader.out.scene.cameras.push_back(camera);
  reader.exact.cameras.push_back(translation_of(reader.world.exact[number]));
}

int accessor_of(const tinygltf::Value& attributes, const char* key) {
  return int(number_in(attributes, key, -1));
}

/// The transforms of EXT_mesh_gpu_instancing below the node's own; one identity without it.
Result<std::vector<Mat34>> copies_of(const GltfReader& reader, const tinygltf::Node& node,
                                     const std::string& where) {
  const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
  if (extension == node.extensions.end()) return std::vector<Mat34>(1);
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  Numbers t, r, s;
  size_t count = 0;
  const auto read = [&](const char* key, size_t components, Numbers& out) -> Status {
    const int accessor = accessor_of(attributes, key);
    if (accessor < 0) return {};
    LUXEL_TRY(out, read_numbers(reader.model, accessor, {components}, where + ", " + key));
    if (count != 0 && out.count() != count)
      return fail(ErrorCode::bad_input, "{}: instance attributes differ in length", where);
    count = out.count();
    return {};
  };
  LUXEL_TRY_STATUS(read("TRANSLATION", 3, t));
  LUXEL_TRY_STATUS(read("ROTATION", 4, r));
  LUXEL_TRY_STATUS(read("SCALE", 3, s));
  std::vector<Mat34> copies(count);
  for (size_t i = 0; i < count; ++i) {
    const auto vec3_at = [&](const Numbers& n, Vec3 fallback) {
      return n.values.empty() ? fallback
                              : Vec3{n.values[3 * i], n.values[3 * i + 1], n.values[3 * i + 2]};
    };
    const float* q = r.values.empty() ? nullptr : &r.values[4 * i];
    copies[i] = translation(vec3_at(t, {})) *
                (q ? rounded(rotation(q[0], q[1], q[2], q[3])) : Mat34{}) *
                scaling(vec3_at(s, {1, 1, 1}));
  }
  return copies;
}

/// Lightmap settings in the extras of nodes and meshes: "luxel": {"density": 2, "bake": false} or,
/// as Blender's custom properties, "luxel_density": 2, "luxel_bake": false.
struct LightmapExtras {
  std::optional<float> density;
  std::optional<bool> bake;
};

/// Anything else than a number, or true and false, is left out with a warning.
LightmapExtras lightmap_extras(GltfReader& reader, const tinygltf::Value& extras,
                               const std::string& where) {
  LightmapExtras out;
  if (const tinygltf::Value* v = luxel_extra(extras, "density", "luxel_density")) {
    const double density = v->IsNumber() ? v->GetNumberAsDouble() : 0;
    if (density >= double(scene::kMinTexelDensity) && density <= double(scene::kMaxTexelDensity))
      out.density = float(density);
    else
      reader.warn("{}: extras.luxel.density is not a number from {} to {} and is ignored", where,
                  scene::kMinTexelDensity, scene::kMaxTexelDensity);
  }
  if (const tinygltf::Value* v = luxel_extra(extras, "bake", "luxel_bake")) {
    if (v->IsBool())
      out.bake = v->Get<bool>();
    else if (v->IsNumber())
      out.bake = v->GetNumberAsDouble() != 0;
    else
      reader.warn("{}: extras.luxel.bake is neither true nor false and is ignored", where);
  }
  return out;
}

/// Values of the first, else of the second.
LightmapExtras first_of(const LightmapExtras& a, const LightmapExtras& b) {
  return {a.density ? a.density : b.density, a.bake ? a.bake : b.bake};
}

/// Poses of one mesh without a skin that nodes have in common.
using KnownPoses = std::map<std::pair<int, std::vector<double>>, uint32_t>;

/// The scene's mesh that a node draws.
Result<uint32_t> mesh_of(GltfReader& reader, size_t index, KnownPoses& known) {
  const tinygltf::Node& node = reader.model.nodes[index];
  if (!has_own_pose(reader.model, node)) return uint32_t(node.mesh);
  const std::pair key{node.mesh, node.weights};
  if (const auto found = known.find(key); node.skin < 0 && found != known.end())
    return found->second;
  const auto mesh = uint32_t(reader.out.scene.meshes.size());
  LUXEL_TRY(scene::Mesh posed, posed_mesh(reader, index));
  reader.out.scene.meshes.push_back(std::move(posed));
  if (node.skin < 0) known[key] = mesh;
  return mesh;
}

/// A skin says where in the world its vertices are, whatever the node says that draws them.
Status add_instances(GltfReader& reader, size_t index, const LightmapExtras& lightmap,
                     KnownPoses& known) {
  const tinygltf::Node& node = reader.model.nodes[index];
  if (node.mesh < 0) return {};
  LUXEL_TRY(const uint32_t mesh, mesh_of(reader, index, known));
  if (reader.out.scene.meshes[mesh].triangles.empty()) return {};
  std::vector<Mat34> copies(1);
  if (node.skin < 0) {
    LUXEL_TRY(copies,
              copies_of(reader, node, reader.source.name + ": " + label("node", index, node.name)));
  }
  const bool has_place = node.skin < 0;
  const std::string& mesh_name = reader.model.meshes[size_t(node.mesh)].name;
  for (const Mat34& copy : copies) {
    reader.out.scene.instances.push_back({node.name.empty() ? mesh_name : node.name, mesh,
                                          has_place ? reader.world.rounded[index] * copy : copy,
                                          lightmap.density.value_or(1.0f),
                                          lightmap.bake.value_or(true)});
    reader.exact.instances.push_back(has_place ? reader.world.exact[index] * to_double(copy)
                                               : to_double(copy));
  }
  reader.out.node_of_instance.resize(reader.out.scene.instances.size(), uint32_t(index));
  return {};
}

/// The nodes that are no other's child.
std::vector<int> top_nodes(const tinygltf::Model& model) {
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children) is_child[size_t(child)] = true;
  std::vector<int> top;
  for (size_t i = 0; i < model.nodes.size(); ++i)
    if (!is_child[i]) top.push_back(int(i));
  return top;
}

/// The nodes to start from: those of the default scene, of the first one, or all roots.
std::vector<int> root_nodes(GltfReader& reader) {
  const tinygltf::Model& model = reader.model;
  if (!model.scenes.empty()) return model.scenes[size_t(std::max(model.defaultScene, 0))].nodes;
  std::vector<int> roots = top_nodes(model);
  if (!roots.empty()) reader.warn("it has no scene; all its nodes are used");
  return roots;
}

}  // namespace

WorldTransforms world_transforms(const tinygltf::Model& model) {
  WorldTransforms world{std::vector<Mat34>(model.nodes.size()),
                        std::vector<DMat34>(model.nodes.size())};
  const auto place = [&](size_t node, const Mat34& parent, const DMat34& exact_parent) {
    const auto [local, exact] = local_transforms(model.nodes[node]);
    world.rounded[node] = parent * local, world.exact[node] = exact_parent * exact;
  };
  std::vector<int> stack = top_nodes(model);
  for (const int top : stack) place(size_t(top), {}, {});
  while (!stack.empty()) {
    const auto parent = size_t(stack.back());
    stack.pop_back();
    for (const int child : model.nodes[parent].children) {
      place(size_t(child), world.rounded[parent], world.exact[parent]);
      stack.push_back(child);
    }
  }
  return world;
}

Status read_nodes(GltfReader& reader) {
  struct Visit {
    int node;
    LightmapExtras inherited{};
  };
  // A stack of our own: a chain of nodes may be longer than the program's. Children are pushed last
  // first, so that instances come in the order of the file.
  std::vector<Visit> stack;
  const auto push = [&](const std::vector<int>& nodes, const LightmapExtras& inherited) {
    for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) stack.push_back({*it, inherited});
  };
  // Extras of meshes are read once: nodes may share them.
  std::vector<LightmapExtras> of_mesh;
  for (size_t m = 0; m < reader.model.meshes.size(); ++m)
    of_mesh.push_back(lightmap_extras(reader, reader.model.meshes[m].extras,
                                      label("mesh", m, reader.model.meshes[m].name)));
  KnownPoses known;
  push(root_nodes(reader), {});
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const auto number = size_t(visit.node);
    const tinygltf::Node& node = reader.model.nodes[number];
    const LightmapExtras own =
        lightmap_extras(reader, node.extras, label("node", number, node.name));
    const LightmapExtras inherited = first_of(own, visit.inherited);
    LUXEL_TRY_STATUS(add_instances(
        reader, number,
        node.mesh < 0 ? inherited
                      : first_of(first_of(own, of_mesh[size_t(node.mesh)]), visit.inherited),
        known));
    add_light(reader, number);
    add_camera(reader, number);
    push(node.children, inherited);
  }
  return {};
}

}  // namespace luxel::import
