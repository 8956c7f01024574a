// Every index of a glTF document points at something.
#include "luxel/import/gltf_check_steps.h"
#include "luxel/import/readers.h"

namespace luxel::import {
namespace {

Status check_index_list(const Json& document, const Json& holder, const char* key,
                        const char* target, const std::string& where) {
  if (!holder.contains(key)) return {};
  if (!holder[key].is_array())
    return fail(ErrorCode::bad_input, "{}: {} is not a list", where, key);
  for (const Json& value : holder[key])
    LUXEL_TRY_STATUS(check_index(document, Json{{key, value}}, key, target, where));
  return {};
}

struct Reference {
  const char *list, *kind, *key, *target;
};
constexpr Reference kReferences[] = {
    {"bufferViews", "buffer view", "buffer", "buffers"},
    {"accessors", "accessor", "bufferView", "bufferViews"},
    {"images", "image", "bufferView", "bufferViews"},
    {"textures", "texture", "source", "images"},
    {"textures", "texture", "sampler", "samplers"},
    {"nodes", "node", "mesh", "meshes"},
    {"nodes", "node", "camera", "cameras"},
    {"nodes", "node", "skin", "skins"},
    {"skins", "skin", "skeleton", "nodes"},
    {"skins", "skin", "inverseBindMatrices", "accessors"},
};

Status check_indices_of(const Json& document, const Json& primitive, const std::string& where) {
  LUXEL_TRY_STATUS(check_index(document, primitive, "indices", "accessors", where));
  LUXEL_TRY_STATUS(check_index(document, primitive, "material", "materials", where));
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object())
    return fail(ErrorCode::bad_input, "{}: it has no attributes", where);
  for (const auto& item : attributes->items())
    LUXEL_TRY_STATUS(check_index(document, *attributes, item.key().c_str(), "accessors", where));
  const auto targets = primitive.find("targets");
  if (targets == primitive.end()) return {};
  if (!targets->is_array()) return fail(ErrorCode::bad_input, "{}: targets is not a list", where);
  for (const Json& target : *targets) {
    if (!target.is_object())
      return fail(ErrorCode::bad_input, "{}: a morph target is not an object", where);
    for (const auto& item : target.items())
      LUXEL_TRY_STATUS(check_index(document, target, item.key().c_str(), "accessors", where));
  }
  return {};
}

/// Textures are named by objects {"index": ...} anywhere in a material, its extensions included.
Status check_texture_indices(const Json& document, const Json& object, const std::string& where) {
  for (const auto& item : object.items()) {
    if (!item.value().is_object() || item.key() == "extras") continue;
    if (item.key().ends_with("Texture"))
      LUXEL_TRY_STATUS(
          check_index(document, item.value(), "index", "textures", where + ", " + item.key()));
    LUXEL_TRY_STATUS(check_texture_indices(document, item.value(), where));
  }
  return {};
}

/// Extensions put the lights' list at the top, their indices and instances' accessors into nodes.
Status check_node_extensions(const Json& document, const Json& node, const std::string& where) {
  const auto extensions = node.find("extensions");
  if (extensions == node.end() || !extensions->is_object()) return {};
  if (const auto light = extensions->find("KHR_lights_punctual"); light != extensions->end()) {
    static const Json::json_pointer kLights("/extensions/KHR_lights_punctual/lights");
    const Json lights = document.contains(kLights) ? document[kLights] : Json::array();
    LUXEL_TRY_STATUS(check_index(Json{{"lights", lights}}, *light, "light", "lights", where));
  }
  if (const auto many = extensions->find("EXT_mesh_gpu_instancing"); many != extensions->end()) {
    const auto attributes = many->find("attributes");
    if (!many->is_object() || attributes == many->end() || !attributes->is_object())
      return fail(ErrorCode::bad_input, "{}: EXT_mesh_gpu_instancing has no attributes", where);
    for (const auto& item : attributes->items())
      LUXEL_TRY_STATUS(check_index(document, *attributes, item.key().c_str(), "accessors", where));
  }
  return {};
}

/// The pictures that extensions give a texture besides, or instead of, its own.
Status check_texture_extensions(const Json& document, const Json& texture,
                                const std::string& where) {
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu"}) {
    LUXEL_TRY(const Json* extension, extension_of(texture, name, where));
    if (extension != nullptr)
      LUXEL_TRY_STATUS(check_index(document, *extension, "source", "images", where + ", " + name));
  }
  return {};
}

}  // namespace

Status check_index(const Json& document, const Json& holder, const char* key, const char* target,
                   const std::string& where) {
  if (!holder.is_object() || !holder.contains(key)) return {};
  const size_t size = list_of(document, target).size();
  const Json& value = holder[key];
  if (!value.is_number_integer() || value.get<double>() < 0 || value.get<double>() >= double(size))
    return fail(ErrorCode::bad_input, "{}: {} {} is out of range, there are {} {}", where, key,
                value.dump(), size, target);
  return {};
}

Status check_primitives(
    const Json& document, const std::string& file,
    const std::function<Status(const Json& primitive, const std::string& where)>& check) {
  const Json& meshes = list_of(document, "meshes");
  for (size_t m = 0; m < meshes.size(); ++m) {
    const Json& primitives = meshes[m]["primitives"];
    for (size_t p = 0; p < primitives.size(); ++p)
      LUXEL_TRY_STATUS(check(primitives[p], fmt::format("{}: {}, primitive {}", file,
                                                        name_of("mesh", m, meshes[m]), p)));
  }
  return {};
}

Result<const Json*> extension_of(const Json& object, const char* name, const std::string& where) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto extension = extensions->find(name);
  if (extension == extensions->end()) return nullptr;
  if (!extension->is_object())
    return fail(ErrorCode::bad_input, "{}: {} is {}, must be an object", where, name,
                extension->dump());
  return &*extension;
}

std::string name_of(const char* kind, size_t index, const Json& object) {
  const auto name = object.is_object() ? object.find("name") : object.end();
  const bool named = object.is_object() && name != object.end() && name->is_string();
  return label(kind, index, named ? name->get<std::string>() : "");
}

const Json& list_of(const Json& document, const char* key) {
  static const Json kEmpty = Json::array();
  const auto list = document.find(key);
  return list == document.end() ? kEmpty : *list;
}

Status check_lists(const Json& document, const std::string& file) {
  for (const char* key : {"accessors", "buffers", "bufferViews", "cameras", "images", "materials",
                          "meshes", "nodes", "samplers", "scenes", "skins", "textures"}) {
    if (!document.contains(key)) continue;
    if (!document[key].is_array())
      return fail(ErrorCode::bad_input, "{}: {} is not a list", file, key);
    for (size_t i = 0; i < document[key].size(); ++i)
      if (!document[key][i].is_object())
        return fail(ErrorCode::bad_input, "{}: {}[{}] is not an object", file, key, i);
  }
  const Json& meshes = list_of(document, "meshes");
  for (size_t m = 0; m < meshes.size(); ++m) {
    const auto primitives = meshes[m].find("primitives");
    if (primitives == meshes[m].end() || !primitives->is_array())
      return fail(ErrorCode::bad_input, "{}: {} has no list of primitives", file,
                  name_of("mesh", m, meshes[m]));
    for (const Json& primitive : *primitives)
      if (!primitive.is_object())
        return fail(ErrorCode::bad_input, "{}: {} has a primitive that is not an object", file,
                    name_of("mesh", m, meshes[m]));
  }
  return {};
}

Status check_indices(const Json& document, const std::string& file) {
  // Single indices of lists at the top.
  for (const Reference& r : kReferences) {
    const Json& list = list_of(document, r.list);
    for (size_t i = 0; i < list.size(); ++i)
      LUXEL_TRY_STATUS(check_index(document, list[i], r.key, r.target,
                                   file + ": " + name_of(r.kind, i, list[i])));
  }
  // Indices deeper in objects.
  LUXEL_TRY_STATUS(
      check_primitives(document, file, [&](const Json& primitive, const std::string& where) {
        return check_indices_of(document, primitive, where);
      }));
  const Json& textures = list_of(document, "textures");
  for (size_t i = 0; i < textures.size(); ++i)
    LUXEL_TRY_STATUS(check_texture_extensions(document, textures[i],
                                              file + ": " + name_of("texture", i, textures[i])));
  const Json& materials = list_of(document, "materials");
  for (size_t i = 0; i < materials.size(); ++i)
    LUXEL_TRY_STATUS(check_texture_indices(document, materials[i],
                                           file + ": " + name_of("material", i, materials[i])));
  // Lists of indices.
  const Json& nodes = list_of(document, "nodes");
  for (size_t i = 0; i < nodes.size(); ++i) {
    const std::string where = file + ": " + name_of("node", i, nodes[i]);
    LUXEL_TRY_STATUS(check_index_list(document, nodes[i], "children", "nodes", where));
    LUXEL_TRY_STATUS(check_node_extensions(document, nodes[i], where));
  }
  const Json& skins = list_of(document, "skins");
  for (size_t i = 0; i < skins.size(); ++i) {
    const std::string where = file + ": " + name_of("skin", i, skins[i]);
    if (!skins[i].contains("joints"))
      return fail(ErrorCode::bad_input, "{}: it has no joints", where);
    LUXEL_TRY_STATUS(check_index_list(document, skins[i], "joints", "nodes", where));
  }
  const Json& scenes = list_of(document, "scenes");
  for (size_t i = 0; i < scenes.size(); ++i)
    LUXEL_TRY_STATUS(check_index_list(document, scenes[i], "nodes", "nodes",
                                      file + ": " + name_of("scene", i, scenes[i])));
  return check_index(document, document, "scene", "scenes", file);
}

}  // namespace luxel::import
