#include "luxel/export/gltf_material.h"

#include <algorithm>
#include <cmath>

#include "luxel/export/json_parts.h"
#include "luxel/image/codec.h"
#include "luxel/scene/specular.h"

namespace luxel::export_ {
namespace {

using nlohmann::json;

constexpr int kNearest = 9728, kLinear = 9729, kLinearMipmapLinear = 9987;

int wrap_code(scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::clamp:
      return 33071;
    case scene::Wrap::mirror:
      return 33648;
    case scene::Wrap::repeat:
      break;
  }
  return 10497;
}

json rgb(Rgb c) { return {c.x, c.y, c.z}; }

bool starts_with(std::span<const std::byte> bytes, std::initializer_list<int> magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](int m, std::byte b) { return std::byte(m) == b; });
}

/// The bytes' own word on what they are: glTF takes PNG and JPEG; "" for anything else.
std::string picture_type(std::span<const std::byte> bytes) {
  if (starts_with(bytes, {0x89, 'P', 'N', 'G'})) return "image/png";
  if (starts_with(bytes, {0xFF, 0xD8, 0xFF})) return "image/jpeg";
  return {};
}

size_t append_image(Glb& glb, std::span<const std::byte> bytes, const std::string& type,
                    const std::string& name) {
  json image = {{"bufferView", append_view(glb, bytes, 0, 0)}, {"mimeType", type}};
  if (!name.empty()) image["name"] = name;
  return append(glb, "images", std::move(image));
}

/// The file the texture came from where glTF allows it, else a PNG of its pixels.
size_t image_index(Glb& glb, MaterialBook& book, const scene::Scene& scene, uint32_t texture) {
  if (const auto known = book.images.find(texture); known != book.images.end())
    return known->second;
  const scene::Texture& t = scene.textures[texture];
  const std::string type = picture_type(t.encoded);
  const size_t index = type.empty()
                           ? append_image(glb, image::encode_png({t.width, t.height, 4, t.rgba}),
                                          "image/png", t.name)
                           : append_image(glb, t.encoded, type, t.name);
  return book.images[texture] = index;
}

size_t texture_index(Glb& glb, MaterialBook& book, size_t image, std::array<int, 4> sampler) {
  if (!book.samplers.contains(sampler))
    book.samplers[sampler] = append(glb, "samplers",
                                    {{"wrapS", sampler[0]},
                                     {"wrapT", sampler[1]},
                                     {"magFilter", sampler[2]},
                                     {"minFilter", sampler[3]}});
  const std::array<size_t, 2> key{image, book.samplers[sampler]};
  if (!book.textures.contains(key))
    book.textures[key] = append(glb, "textures", {{"source", key[0]}, {"sampler", key[1]}});
  return book.textures[key];
}

/// A textureInfo; null where there is no texture or no coordinates for it.
json texture_info(Glb& glb, MaterialBook& book, const scene::Scene& scene,
                  const scene::TextureRef& ref, TexcoordSlots slots) {
  if (ref.texture == scene::kNone) return nullptr;
  const int slot = slots[ref.uv_set == 1 ? 1 : 0];
  if (slot < 0) return nullptr;
  const bool nearest = ref.filter == scene::Filter::nearest;
  const size_t image = image_index(glb, book, scene, ref.texture);
  json info = {{"index", texture_index(glb, book, image,
                                       {wrap_code(ref.wrap_u), wrap_code(ref.wrap_v),
                                        nearest ? kNearest : kLinear,
                                        nearest ? kNearest : kLinearMipmapLinear})}};
  if (slot != 0) info["texCoord"] = slot;
  if (ref.offset != Vec2{0, 0} || ref.scale != Vec2{1, 1} || ref.rotation != 0) {
    object_in(info, {"extensions"})["KHR_texture_transform"] = {
        {"offset", {ref.offset.x, ref.offset.y}},
        {"scale", {ref.scale.x, ref.scale.y}},
        {"rotation", ref.rotation}};
    glb.extensions_used.insert("KHR_texture_transform");
  }
  return info;
}

void set_if(json& object, const char* key, json value) {
  if (!value.is_null()) object[key] = std::move(value);
}

json surface(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Material& m,
             TexcoordSlots slots) {
  const auto unit = [](float v) { return std::clamp(v, 0.0f, 1.0f); };
  const Rgb base = min(max(m.base_color, Rgb{}), Rgb{1, 1, 1});
  json pbr = {{"baseColorFactor", {base.x, base.y, base.z, unit(m.alpha)}},
              {"metallicFactor", unit(m.metallic)},
              {"roughnessFactor", unit(m.roughness)}};
  set_if(pbr, "baseColorTexture", texture_info(glb, book, scene, m.base_color_texture, slots));
  set_if(pbr, "metallicRoughnessTexture",
         texture_info(glb, book, scene, m.metallic_texture, slots));
  return pbr;
}

void set_strength(Glb& glb, float strength, json& out) {
  if (strength == 1) return;
  object_in(out,
            {"extensions"})["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
  glb.extensions_used.insert("KHR_materials_emissive_strength");
}

void set_emission(Glb& glb, MaterialBook& book, const scene::Scene& scene, const scene::Material& m,
                  TexcoordSlots slots, json& out) {
  const float largest = max_component(m.emission);
  if (!(largest > 0)) return;
  // A factor must lie in [0, 1]. The strength is a power of two, so that dividing by it and
  // multiplying with it again lose no bit.
  const float strength = largest > 1 ? std::exp2(std::ceil(std::log2(largest))) : 1.0f;
  out["emissiveFactor"] = rgb(m.emission / strength);
  set_if(out, "emissiveTexture", texture_info(glb, book, scene, m.emission_texture, slots));
  set_strength(glb, strength, out);
}

void set_normal_map(Glb& glb, MaterialBook& book, const scene::Scene& scene,
                    const scene::Material& m, TexcoordSlots slots, json& out) {
  json info = texture_info(glb, book, scene, m.normal_texture, slots);
  if (info.is_null()) return;
  if (m.normal_scale != 1) info["scale"] = m.normal_scale;
  out["normalTexture"] = std::move(info);
}

void set_transmission(Glb& glb, MaterialBook& book, const scene::Scene& scene,
                      const scene::Material& m, TexcoordSlots slots, json& out) {
  if (!(m.transmission > 0)) return;
  json& extension = object_in(out, {"extensions"})["KHR_materials_transmission"];
  extension = {{"transmissionFactor", m.transmission}};
  set_if(extension, "transmissionTexture",
         texture_info(glb, book, scene, m.transmission_texture, slots));
  glb.extensions_used.insert("KHR_materials_transmission");
}

void set_diffuse_transmission(Glb& glb, MaterialBook& book, const scene::Scene& scene,
                              const scene::Material& m, TexcoordSlots slots, json& out) {
  if (!(m.diffuse_transmission > 0)) return;
  json& extension = object_in(out, {"extensions"})["KHR_materials_diffuse_transmission"];
  extension = {
      {"diffuseTransmissionFactor", m.diffuse_transmission},
      {"diffuseTransmissionColorFactor", rgb(min(m.diffuse_transmission_color, Rgb{1, 1, 1}))}};
  set_if(extension, "diffuseTransmissionTexture",
         texture_info(glb, book, scene, m.diffuse_transmission_texture, slots));
  set_if(extension, "diffuseTransmissionColorTexture",
         texture_info(glb, book, scene, m.diffuse_transmission_color_texture, slots));
  glb.extensions_used.insert("KHR_materials_diffuse_transmission");
}

/// Phong's highlight of a material that is no metal, as import/ will find it again. Only where
/// something was set: a scene that asks for no highlight is written without one.
void set_highlight(Glb& glb, const scene::Material& m, json& out) {
  if (!(max_component(m.specular) > 0) || m.metallic > 0) return;
  const Rgb color = scene::f0_of(m.specular, m.sharpness) / scene::kDielectricF0;
  object_in(out, {"pbrMetallicRoughness"})["roughnessFactor"] = scene::roughness_of(m.sharpness);
  object_in(out, {"extensions"})["KHR_materials_specular"] = {{"specularColorFactor", rgb(color)}};
  glb.extensions_used.insert("KHR_materials_specular");
}

void set_alpha(const scene::Material& m, json& out) {
  if (m.alpha_mode == scene::AlphaMode::blend) out["alphaMode"] = "BLEND";
  if (m.alpha_mode != scene::AlphaMode::mask) return;
  out["alphaMode"] = "MASK";
  out["alphaCutoff"] = std::max(m.alpha_cutoff, 0.0f);
}

void set_unlit(Glb& glb, json& out) {
  object_in(out, {"extensions"})["KHR_materials_unlit"] = json::object();
  glb.extensions_used.insert("KHR_materials_unlit");
}

/// The picture of a page as the material's colour, or as what it emits.
void set_picture(Glb& glb, const MaterialBook& book, const json& picture, json& out) {
  if (book.attach == Attach::combined) {
    object_in(out, {"pbrMetallicRoughness"})["baseColorTexture"] = picture;
    set_unlit(glb, out);
    return;
  }
  out["emissiveFactor"] = {1, 1, 1};
  out["emissiveTexture"] = picture;
  set_strength(glb, book.strength, out);
  // A black surface would still shine like plastic in the lights of the file or of a viewer.
  object_in(out, {"extensions"})["KHR_materials_specular"] = {{"specularFactor", 0}};
  glb.extensions_used.insert("KHR_materials_specular");
}

json material_json(Glb& glb, MaterialBook& book, const scene::Scene& scene,
                   const scene::Material& m, TexcoordSlots slots, MaterialPlace place) {
  json out = {{"pbrMetallicRoughness", surface(glb, book, scene, m, slots)}};
  if (!m.name.empty()) out["name"] = m.name;
  set_emission(glb, book, scene, m, slots, out);
  set_normal_map(glb, book, scene, m, slots, out);
  set_transmission(glb, book, scene, m, slots, out);
  set_diffuse_transmission(glb, book, scene, m, slots, out);
  set_alpha(m, out);
  if (m.double_sided) out["doubleSided"] = true;
  if (m.unlit) set_unlit(glb, out);
  // Baked light is diffuse, and unlit materials have no highlight.
  if (book.lightmap.empty() && !m.unlit) set_highlight(glb, m, out);
  if (book.lightmap.empty() || m.unlit) return out;
  object_in(out, {"extras", "luxel"})["lightmap"] = book.lightmap[place.page].name + ".exr";
  if (!place.attached) return out;
  if (book.attach != Attach::lightmap) {
    set_picture(glb, book, book.lightmap[place.page].picture, out);
    return out;
  }
  object_in(out, {"extensions"})["MOZ_lightmap"] = book.lightmap[place.page].picture;
  glb.extensions_used.insert("MOZ_lightmap");
  return out;
}

}  // namespace

size_t material_index(Glb& glb, MaterialBook& book, const scene::Scene& scene, uint32_t material,
                      TexcoordSlots slots, MaterialPlace place) {
  const scene::Material& m = shown_material(book, scene, material, place);
  // Slots that no texture asks for make no difference, and no second copy of the material.
  std::array<bool, 2> used{};
  for (const scene::TextureRef* ref : scene::textures_of(m))
    if (ref->texture != scene::kNone) used[ref->uv_set == 1 ? 1 : 0] = true;
  for (size_t set = 0; set < 2; ++set)
    if (!used[set]) slots[set] = -1;

  const std::tuple key{material, slots, place.page, place.attached};
  if (const auto known = book.materials.find(key); known != book.materials.end())
    return known->second;
  const size_t index = append(glb, "materials", material_json(glb, book, scene, m, slots, place));
  return book.materials[key] = index;
}

size_t append_lightmap_texture(Glb& glb, MaterialBook& book, std::span<const std::byte> png,
                               const std::string& name, bool mipmaps) {
  const int clamp = wrap_code(scene::Wrap::clamp);
  return texture_index(glb, book, append_image(glb, png, "image/png", name),
                       {clamp, clamp, kLinear, mipmaps ? kLinearMipmapLinear : kLinear});
}

std::vector<scene::Material> materials_without_light(const scene::Scene& scene, Attach attach) {
  std::vector<scene::Material> out;
  for (const scene::Material& m : scene.materials) {
    if (m.unlit) {
      out.push_back(m);
      continue;
    }
    scene::Material plain;
    plain.name = m.name, plain.double_sided = m.double_sided;
    plain.alpha_mode = m.alpha_mode, plain.alpha_cutoff = m.alpha_cutoff;
    if (m.transmission > 0 && m.alpha_mode == scene::AlphaMode::opaque)
      plain.alpha_mode = scene::AlphaMode::blend;
    if (attach == Attach::emissive) {
      plain.base_color = {};
      plain.alpha = m.alpha * (1 - m.transmission);
      if (m.alpha_mode != scene::AlphaMode::opaque) plain.base_color_texture = m.base_color_texture;
    }
    out.push_back(std::move(plain));
  }
  return out;
}

}  // namespace luxel::export_
