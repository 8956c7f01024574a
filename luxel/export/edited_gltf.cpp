#include "luxel/export/edited_gltf.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "luxel/base/base64.h"
#include "luxel/base/shown_text.h"
#include "luxel/export/gltf_tree.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::export_ {
namespace {

constexpr const char *kStrength = "KHR_materials_emissive_strength",
                     *kGlossiness = "KHR_materials_pbrSpecularGlossiness",
                     *kCopies = "EXT_mesh_gpu_instancing";

OrderedJson rgb_of(Rgb c) { return {c.x, c.y, c.z}; }

/// A file taken apart.
struct GltfFile {
  OrderedJson document;
  bool is_glb = false;
  std::span<const std::byte> rest;  ///< of a .glb, the chunks that follow the JSON
};

uint32_t word_at(std::span<const std::byte> bytes, size_t at) {
  uint32_t out = 0;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

std::optional<GltfFile> taken_apart(std::span<const std::byte> file) {
  constexpr size_t kBefore = 20;  // the header, then length and type of the JSON
  GltfFile out;
  out.is_glb = file.size() >= kBefore && std::memcmp(file.data(), "glTF", 4) == 0;
  std::span<const std::byte> text = file;
  if (out.is_glb) {
    const uint32_t length = word_at(file, 12), whole = word_at(file, 8);
    if (whole > file.size() || whole < kBefore || length > whole - kBefore) return std::nullopt;
    text = file.subspan(kBefore, length);
    out.rest = file.subspan(kBefore + length, whole - kBefore - length);
  }
  const char* first = reinterpret_cast<const char*>(text.data());
  out.document = OrderedJson::parse(first, first + text.size(), nullptr, false);
  return out.document.is_object() ? std::optional(std::move(out)) : std::nullopt;
}

void put_word(uint32_t value, std::vector<std::byte>& out) {
  const auto raw = std::as_bytes(std::span(&value, 1));
  out.insert(out.end(), raw.begin(), raw.end());
}

Result<std::vector<std::byte>> put_together(const GltfFile& file, const std::string& name) {
  std::string text = json_text(file.document, file.is_glb ? -1 : 1);
  std::vector<std::byte> out;
  if (file.is_glb) {
    while (text.size() % 4 != 0) text += ' ';
    const size_t whole = 20 + text.size() + file.rest.size();
    if (whole > UINT32_MAX)
      return fail(ErrorCode::unsupported,
                  "{}: together with the files it names it has more than 4 GB as .glb", name);
    for (const uint32_t word : {0x46546C67u, 2u, uint32_t(whole), uint32_t(text.size()),
                                0x4E4F534Au})  // "glTF", its version, sizes, "JSON"
      put_word(word, out);
  }
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  out.insert(out.end(), bytes.begin(), bytes.end());
  out.insert(out.end(), file.rest.begin(), file.rest.end());
  return out;
}

/// MIME type of a picture's data URI, by the ending of the picture's name.
std::string type_of(const std::string& uri) {
  const auto ends = [&](const char* with) {
    const std::string_view end(with);
    return uri.size() >= end.size() &&
           std::equal(end.rbegin(), end.rend(), uri.rbegin(),
                      [](char a, char b) { return a == std::tolower(b); });
  };
  if (ends(".png")) return "image/png";
  if (ends(".jpg") || ends(".jpeg")) return "image/jpeg";
  if (ends(".webp")) return "image/webp";
  if (ends(".ktx2")) return "image/ktx2";
  return "application/octet-stream";
}

/// Buffers and pictures that lie in other files come into this one.
Status bring_in_files(OrderedJson& document, const std::string& name, const ReadUri& read) {
  for (const char* kind : {"buffers", "images"}) {
    if (!document.contains(kind)) continue;
    for (OrderedJson& part : document[kind]) {
      const std::string uri = part.value("uri", std::string());
      if (uri.empty() || uri.starts_with("data:")) continue;
      LUXEL_TRY(const std::vector<std::byte> bytes, read(uri, name + ": one of its " + kind));
      const std::string type = part.value("mimeType", type_of(uri));
      part["uri"] = "data:" + type + ";base64," + base64(bytes);
    }
  }
  return {};
}

void use_extension(OrderedJson& document, const char* name) {
  OrderedJson& used = document["extensionsUsed"];
  if (used.is_null()) used = OrderedJson::array();
  if (std::ranges::find(used, OrderedJson(name)) == used.end()) used.push_back(name);
}

// Materials.

/// True where the colour is that of KHR_materials_pbrSpecularGlossiness.
bool is_glossy(const OrderedJson& material) {
  return material.contains("extensions") && material["extensions"].contains(kGlossiness) &&
         !material["extensions"].contains("KHR_materials_unlit");
}

void set_color(Rgb color, OrderedJson& material) {
  color = min(max(color, Rgb{}), Rgb{1, 1, 1});
  const bool glossy = is_glossy(material);
  OrderedJson& part =
      glossy ? material["extensions"][kGlossiness] : material["pbrMetallicRoughness"];
  OrderedJson& factor = part[glossy ? "diffuseFactor" : "baseColorFactor"];
  const OrderedJson alpha = factor.is_array() && factor.size() > 3 ? factor[3] : OrderedJson(1);
  factor = rgb_of(color);
  factor.push_back(alpha);
}

/// A factor lies in [0, 1]. The strength is a power of two, so that no bit is lost.
void set_emission(const GltfEdits::Material& edit, OrderedJson& document, OrderedJson& material) {
  const Rgb light = edit.now.emission;
  const float largest = max_component(light);
  const float strength = largest > 1 ? std::exp2(std::ceil(std::log2(largest))) : 1;
  material["emissiveFactor"] = rgb_of(light / strength);
  // Where nothing glowed its picture was not looked at.
  if (max_component(edit.before.emission) == 0) material.erase("emissiveTexture");
  const bool has_strength =
      material.contains("extensions") && material["extensions"].contains(kStrength);
  if (strength == 1 && !has_strength) return;
  material["extensions"][kStrength]["emissiveStrength"] = strength;
  use_extension(document, kStrength);
}

/// Metal is known to glTF's own materials alone: others become one, as luxel reads them.
void become_metallic_roughness(OrderedJson& material) {
  const OrderedJson glossy = material["extensions"][kGlossiness];
  OrderedJson& pbr = material["pbrMetallicRoughness"];
  pbr = OrderedJson::object();
  pbr["baseColorFactor"] = glossy.value("diffuseFactor", OrderedJson{1, 1, 1, 1});
  if (glossy.contains("diffuseTexture")) pbr["baseColorTexture"] = glossy["diffuseTexture"];
  pbr["roughnessFactor"] = 1 - glossy.value("glossinessFactor", 1.0);
  drop_extension(material, kGlossiness);
}

void set_metallic(const GltfEdits::Material& edit, OrderedJson& material) {
  if (is_glossy(material)) become_metallic_roughness(material);
  OrderedJson& pbr = material["pbrMetallicRoughness"];
  // Where nothing was metal its picture was not looked at.
  if (edit.before.metallic == 0 && pbr.contains("metallicRoughnessTexture"))
    pbr.erase("metallicRoughnessTexture");
  pbr["metallicFactor"] = edit.now.metallic;
}

/// The material that stands for none becomes one of the file's own.
size_t own_material(size_t material, OrderedJson& document) {
  OrderedJson& list = document["materials"];
  if (list.is_null()) list = OrderedJson::array();
  if (material < list.size()) return material;
  const size_t number = list.size();
  list.push_back(
      {{"name", "default"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0.8, 0.8, 0.8, 1}}, {"metallicFactor", 0}}}});
  for (OrderedJson& mesh : document["meshes"])
    for (OrderedJson& primitive : mesh["primitives"])
      if (!primitive.contains("material")) primitive["material"] = number;
  return number;
}

void edit_materials(const GltfEdits& edits, OrderedJson& document) {
  for (const GltfEdits::Material& edit : edits.materials) {
    const size_t number = own_material(edit.material, document);
    OrderedJson& material = document["materials"][number];
    if (edit.now.base_color != edit.before.base_color) set_color(edit.now.base_color, material);
    if (edit.now.emission != edit.before.emission) set_emission(edit, document, material);
    if (edit.now.metallic != edit.before.metallic) set_metallic(edit, material);
  }
}

// Instances.

/// A light or a camera of a node that moves stays where it is, in a node of its own.
size_t light_apart(GltfTree& tree, size_t node) {
  OrderedJson& from = tree.document["nodes"][node];
  OrderedJson child = OrderedJson::object();
  if (from.contains("name")) child["name"] = from["name"];
  child["extensions"][kLights] = from["extensions"][kLights];
  drop_extension(from, kLights);
  return add_child(tree, node, std::move(child));
}

void camera_apart(GltfTree& tree, size_t node) {
  OrderedJson& from = tree.document["nodes"][node];
  OrderedJson child = OrderedJson::object();
  if (from.contains("name")) child["name"] = from["name"];
  child["camera"] = from["camera"];
  from.erase("camera");
  add_child(tree, node, std::move(child));
}

Eigen::Affine3d in_world(const Eigen::Affine3d& place, DVec3 origin) {
  if (origin == DVec3{}) return place;  // a sum with 0 would make 0 of -0
  return Eigen::Translation3d(origin.x, origin.y, origin.z) * place;
}

/// World of the file from the coordinates that the file has of an instance's mesh.
Eigen::Affine3d place_in_file(const GltfEdits& edits, uint32_t instance, const Mat34& world) {
  const Eigen::Affine3d out = in_world(affine(world), edits.origin);
  if (edits.object_origin.empty()) return out;
  const DVec3 o = edits.object_origin[instance];
  return out * Eigen::Translation3d(-o.x, -o.y, -o.z);
}

/// Where a node is wanted. What only moves far from the origin keeps the digits that single
/// precision has not.
Eigen::Affine3d moved(const GltfEdits& edits, const GltfEdits::Placed& placed,
                      const Eigen::Affine3d& was) {
  const Eigen::Affine3d before = affine(edits.world_from_object[placed.instance]),
                        now = affine(placed.world_from_object);
  if (edits.origin == DVec3{} || now.linear() != before.linear())
    return place_in_file(edits, placed.instance, placed.world_from_object);
  return Eigen::Translation3d(now.translation() - before.translation()) * was;
}

/// Copies of one node become nodes below it, each at its place.
void part_copies(const GltfEdits& edits, const std::vector<Mat34>& world, size_t node,
                 GltfTree& tree) {
  OrderedJson& from = tree.document["nodes"][node];
  OrderedJson child = OrderedJson::object();
  if (from.contains("name")) child["name"] = from["name"];
  child["mesh"] = from["mesh"];
  from.erase("mesh"), drop_extension(from, kCopies);
  // Each comes before those that are there: the last copy first.
  for (size_t i = world.size(); i-- > 0;)
    if (edits.node_of_instance[i] == node)
      tree.wanted[add_child(tree, node, child)] = place_in_file(edits, uint32_t(i), world[i]);
}

/// Errors: one hangs on the joints of a skin, which alone say where it is.
Status move_instances(const GltfEdits& edits, const std::string& name, GltfTree& tree,
                      std::map<uint32_t, size_t>& light_nodes) {
  std::vector<Mat34> world = edits.world_from_object;
  for (const GltfEdits::Placed& placed : edits.placed)
    world[placed.instance] = placed.world_from_object;
  for (const GltfEdits::Placed& placed : edits.placed) {
    const size_t node = edits.node_of_instance[placed.instance];
    const OrderedJson& from = tree.document["nodes"].at(node);
    if (!from.contains("mesh")) continue;  // its copies have been parted
    if (from.contains("skin"))
      return fail(ErrorCode::unsupported,
                  "{}: node {} ({}) hangs on its joints and cannot be moved; move them in your "
                  "modeller",
                  name, node, from.value("name", std::string()));
    if (from.contains("extensions") && from["extensions"].contains(kCopies)) {
      part_copies(edits, world, node, tree);
      continue;
    }
    if (tree.document["nodes"][node].contains("camera")) camera_apart(tree, node);
    if (has_light(tree.document["nodes"][node]))
      light_nodes[uint32_t(node)] = light_apart(tree, node);
    tree.wanted[node] = moved(edits, placed, tree.was[node]);
  }
  return {};
}

// Lights.

/// A light shines along -z of its node.
Mat34 place_of(const scene::PunctualLight& light) {
  const Vec3 back = -normalize(light.direction);
  const Vec3 side = light.side - back * dot(light.side, back);
  if (!(length(side) > 1e-3f)) {
    const Frame frame = frame_around(back);
    return from_columns(frame.tangent, frame.bitangent, back, light.position);
  }
  const Vec3 x = normalize(side);
  return from_columns(x, cross(back, x), back, light.position);
}

void set_intensity(Rgb intensity, OrderedJson& light) {
  const float largest = max_component(intensity);
  if (largest > 0) light["color"] = rgb_of(intensity / largest);
  light["intensity"] = largest;
}

void set_cone(const scene::PunctualLight& now, OrderedJson& light) {
  // glTF wants 0 <= inner < outer <= pi / 2.
  const double outer = std::clamp(double(now.outer_cone_rad), 1e-4, 1.5707963267948966);
  light["spot"]["innerConeAngle"] = std::min(double(now.inner_cone_rad), 0.9999 * outer);
  light["spot"]["outerConeAngle"] = outer;
}

void write_light(const scene::PunctualLight& before, const scene::PunctualLight& now,
                 OrderedJson& light) {
  // The intensity of a light with a profile is a factor that the file does not have.
  if (now.intensity != before.intensity && now.profile == scene::kNone)
    set_intensity(now.intensity, light);
  if (scene::has_cone(now.kind) &&
      (now.inner_cone_rad != before.inner_cone_rad || now.outer_cone_rad != before.outer_cone_rad))
    set_cone(now, light);
  if (now.angular_radius_rad != before.angular_radius_rad)
    light["extras"]["luxel"]["angular_radius_rad"] = now.angular_radius_rad;
}

OrderedJson& light_list(OrderedJson& document) {
  OrderedJson& list = document["extensions"][kLights]["lights"];
  if (list.is_null()) list = OrderedJson::array();
  use_extension(document, kLights);
  return list;
}

/// A light that other nodes have, too, stays theirs.
OrderedJson& own_light(OrderedJson& document, OrderedJson& node) {
  OrderedJson& index = node["extensions"][kLights]["light"];
  OrderedJson& list = light_list(document);
  size_t users = 0;
  for (const OrderedJson& other : document["nodes"])
    users += has_light(other) && other["extensions"][kLights].value("light", SIZE_MAX) == index;
  if (users > 1) {
    OrderedJson copy = list.at(index.get<size_t>());
    list.push_back(std::move(copy));
    index = list.size() - 1;
  }
  return list.at(index.get<size_t>());
}

void edit_lights(const GltfEdits& edits, const std::map<uint32_t, size_t>& apart, GltfTree& tree) {
  const auto node_of = [&](uint32_t light) {
    const uint32_t node = edits.node_of_light[light];
    const auto found = apart.find(node);
    return found == apart.end() ? size_t(node) : found->second;
  };
  for (const GltfEdits::Light& edit : edits.lights) {
    size_t node = node_of(edit.light);
    write_light(edit.before, edit.now, own_light(tree.document, tree.document["nodes"].at(node)));
    if (edit.now.position == edit.before.position && edit.now.direction == edit.before.direction &&
        edit.now.side == edit.before.side)
      continue;
    const OrderedJson& from = tree.document["nodes"][node];
    if (from.contains("mesh") || from.contains("camera")) node = light_apart(tree, node);
    tree.wanted[node] = in_world(affine(place_of(edit.now)), edits.origin);
  }
  for (const uint32_t light : edits.deleted_lights)
    drop_extension(tree.document["nodes"].at(node_of(light)), kLights);
}

void add_light(const scene::PunctualLight& light, DVec3 origin, GltfTree& tree) {
  OrderedJson out = {{"type", std::string(scene::name_of(light.kind))}};
  if (!light.name.empty()) out["name"] = light.name;
  set_intensity(light.intensity, out);
  if (scene::has_cone(light.kind)) set_cone(light, out);
  if (scene::has_disc(light))
    out["extras"]["luxel"]["angular_radius_rad"] = light.angular_radius_rad;
  OrderedJson& list = light_list(tree.document);
  list.push_back(std::move(out));
  OrderedJson node = OrderedJson::object();
  if (!light.name.empty()) node["name"] = light.name;
  node["extensions"][kLights]["light"] = list.size() - 1;
  tree.wanted[add_root(tree, std::move(node))] = in_world(affine(place_of(light)), origin);
}

}  // namespace

Result<std::vector<std::byte>> edited_gltf(std::span<const std::byte> bytes,
                                           const std::string& name, const GltfEdits& edits,
                                           const ReadUri& read) {
  try {
    std::optional<GltfFile> file = taken_apart(bytes);
    if (!file) return fail(ErrorCode::bad_input, "{} is not a glTF file", name);
    LUXEL_TRY_STATUS(bring_in_files(file->document, name, read));
    GltfTree tree = tree_of(file->document);
    std::map<uint32_t, size_t> lights_apart;
    LUXEL_TRY_STATUS(move_instances(edits, name, tree, lights_apart));
    edit_lights(edits, lights_apart, tree);
    for (const scene::PunctualLight& light : edits.new_lights) add_light(light, edits.origin, tree);
    write_places(tree);
    edit_materials(edits, file->document);
    return put_together(*file, name);
  } catch (const std::exception& e) {  // nlohmann-json and memory
    return fail(ErrorCode::io, "cannot rewrite {}: {}", name, e.what());
  }
}

}  // namespace luxel::export_
