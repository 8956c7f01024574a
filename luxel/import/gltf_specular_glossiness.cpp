// KHR_materials_pbrSpecularGlossiness, which older exporters write, in the words of the materials
// that everyone else writes.
#include <algorithm>

#include "luxel/import/gltf_load.h"
#include "luxel/import/gltf_parts.h"
#include "luxel/scene/specular.h"

namespace luxel::import {
namespace {

tinygltf::Value array_of(Rgb c) {
  return tinygltf::Value(tinygltf::Value::Array{
      tinygltf::Value(double(c.x)), tinygltf::Value(double(c.y)), tinygltf::Value(double(c.z))});
}

tinygltf::TextureInfo texture_in(const tinygltf::Value& object, const char* key) {
  tinygltf::TextureInfo info;
  if (!object.IsObject() || !object.Has(key)) return info;
  const tinygltf::Value& value = object.Get(key);
  info.index = int(number_in(value, "index", -1));
  info.texCoord = int(number_in(value, "texCoord", 0));
  if (value.IsObject() && value.Has("extensions") && value.Get("extensions").IsObject())
    info.extensions = value.Get("extensions").Get<tinygltf::Value::Object>();
  return info;
}

double fourth_in(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  return value.IsArray() && value.ArrayLen() > 3 && value.Get(3).IsNumber()
             ? value.Get(3).GetNumberAsDouble()
             : fallback;
}

/// Its specular colour is what is mirrored head on, f0, where KHR_materials_specular scales glTF's
/// own 0.04. The diffuse colour is taken as it is, as that of every other dielectric here: what is
/// mirrored is not taken from it. Of the textures only the diffuse one is read; where the other
/// would say what is mirrored, glTF's own value stands.
void convert(const tinygltf::Value& values, tinygltf::Material& m) {
  const Rgb diffuse = vec3_in(values, "diffuseFactor", {1, 1, 1});
  auto& pbr = m.pbrMetallicRoughness;
  pbr.baseColorFactor = {diffuse.x, diffuse.y, diffuse.z, fourth_in(values, "diffuseFactor", 1)};
  pbr.baseColorTexture = texture_in(values, "diffuseTexture");
  pbr.metallicFactor = 0;
  pbr.metallicRoughnessTexture = {};
  pbr.roughnessFactor = 1 - std::clamp(number_in(values, "glossinessFactor", 1), 0.0, 1.0);
  if (texture_in(values, "specularGlossinessTexture").index >= 0) return;
  const Rgb specular = vec3_in(values, "specularFactor", {1, 1, 1});
  m.extensions["KHR_materials_specular"] = tinygltf::Value(tinygltf::Value::Object{
      {"specularColorFactor", array_of(specular * (1 / scene::kDielectricF0))}});
}

}  // namespace

void convert_specular_glossiness(tinygltf::Model& model) {
  for (tinygltf::Material& m : model.materials) {
    const auto found = m.extensions.find("KHR_materials_pbrSpecularGlossiness");
    // An unlit material has its colour in the usual place.
    if (found == m.extensions.end() || m.extensions.count("KHR_materials_unlit") > 0) continue;
    convert(tinygltf::Value(found->second), m);
  }
}

}  // namespace luxel::import
