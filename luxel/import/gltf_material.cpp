// Materials and their textures.
#include <optional>

#include "luxel/import/gltf_images.h"
#include "luxel/import/gltf_parts.h"
#include "luxel/scene/specular.h"

namespace luxel::import {
namespace {

using scene::TextureRef;

scene::Wrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return scene::Wrap::clamp;
  if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return scene::Wrap::mirror;
  return scene::Wrap::repeat;
}

void apply_transform(TextureRef& ref, const tinygltf::ExtensionMap& extensions) {
  const auto found = extensions.find("KHR_texture_transform");
  if (found == extensions.end() || !found->second.IsObject()) return;
  const tinygltf::Value& transform = found->second;
  ref.offset = vec2_in(transform, "offset", ref.offset);
  ref.scale = vec2_in(transform, "scale", ref.scale);
  ref.rotation = float(number_in(transform, "rotation", ref.rotation));
  ref.uv_set = int(number_in(transform, "texCoord", ref.uv_set));
}

/// The picture to take: the PNG or JPEG, which can go into baked files as it is, before the WebP of
/// an extension that shows the same.
Result<int> image_of(const GltfReader& reader, const tinygltf::Texture& texture, int index,
                     const std::string& user) {
  if (texture.source >= 0) return texture.source;
  if (const auto webp = texture.extensions.find("EXT_texture_webp");
      webp != texture.extensions.end()) {
    const int source = int(number_in(webp->second, "source", -1));
    if (source >= 0) return source;
  }
  const std::string where = fmt::format("{}: {} of {}", reader.source.name,
                                        label("texture", size_t(index), texture.name), user);
  if (texture.extensions.count("KHR_texture_basisu") > 0)
    return fail(ErrorCode::unsupported,
                "{} exists only as KTX2 (KHR_texture_basisu), which luxel cannot decode; export it "
                "with PNG or JPEG textures",
                where);
  return fail(ErrorCode::unsupported,
              "{} has no picture that luxel can decode; export it with PNG or JPEG textures",
              where);
}

Result<TextureRef> read_ref(GltfReader& reader, Pictures& pictures,
                            const tinygltf::TextureInfo& info, const std::string& user,
                            std::string_view instead) {
  TextureRef ref;
  if (info.index < 0) return ref;
  const tinygltf::Texture& texture = reader.model.textures[size_t(info.index)];
  const Result<int> image = image_of(reader, texture, info.index, user);
  const auto none = [&]() -> Result<scene::Texture> { return Failure{image.error()}; };
  LUXEL_TRY(ref.texture,
            image ? load_image(reader, pictures, *image, user, instead)
                  : picture_of(pictures, fmt::format("texture {}", info.index), instead, none));
  ref.uv_set = info.texCoord;
  if (texture.sampler >= 0) {
    const tinygltf::Sampler& sampler = reader.model.samplers[size_t(texture.sampler)];
    ref.wrap_u = wrap_of(sampler.wrapS);
    ref.wrap_v = wrap_of(sampler.wrapT);
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) ref.filter = scene::Filter::nearest;
  }
  apply_transform(ref, info.extensions);
  return ref;
}

/// A mesh has two sets of texture coordinates, the second of which is TEXCOORD_1: lightmaps want
/// it. The first is TEXCOORD_0 or, where textures look at another one, that: luxel's own files have
/// their second set there. Returns its number and makes the textures look at these two.
int choose_first_set(GltfReader& reader, const std::string& user, scene::Material& m) {
  std::optional<int> first;
  bool is_odd = false;
  for (TextureRef* ref : scene::textures_of(m)) {
    if (ref->texture == scene::kNone || ref->uv_set == 1) continue;
    is_odd |= first.value_or(ref->uv_set) != ref->uv_set;
    if (!first) first = ref->uv_set;
    ref->uv_set = 0;
  }
  if (is_odd)
    reader.warn(
        "{} uses more than two sets of texture coordinates; TEXCOORD_1 and TEXCOORD_{} are read",
        user, *first);
  return first.value_or(0);
}

bool is_lost(const tinygltf::TextureInfo& info, const TextureRef& ref) {
  return info.index >= 0 && ref.texture == scene::kNone;
}

/// glTF's own colour is white, which means the picture as it is.
bool states_color(const GltfReader& reader, size_t material) {
  const auto& in = reader.document["materials"][material];
  const auto pbr = in.find("pbrMetallicRoughness");
  return pbr != in.end() && pbr->contains("baseColorFactor");
}

scene::AlphaMode alpha_mode_of(const std::string& mode) {
  if (mode == "MASK") return scene::AlphaMode::mask;
  if (mode == "BLEND") return scene::AlphaMode::blend;
  return scene::AlphaMode::opaque;
}

/// The mean of one channel of a texture, in [0, 1]; 1 without a texture.
float mean_channel(const scene::Scene& scene, const TextureRef& ref, size_t channel) {
  if (ref.texture == scene::kNone) return 1;
  const std::vector<uint8_t>& rgba = scene.textures[ref.texture].rgba;
  uint64_t sum = 0;
  for (size_t i = channel; i < rgba.size(); i += 4) sum += rgba[i];
  return rgba.empty() ? 1.0f : float(double(sum) * 4 / double(rgba.size()) / 255);
}

/// Reflectance of a dielectric head on. An index of 0 stands for infinity. [KHR_materials_ior]
float dielectric_f0(const tinygltf::Material& in) {
  const auto it = in.extensions.find("KHR_materials_ior");
  if (it == in.extensions.end()) return scene::kDielectricF0;
  const double ior = number_in(it->second, "ior", 1.5);
  const double r = ior == 0 ? 1 : (ior - 1) / (ior + 1);
  return ior >= 0 ? float(r * r) : scene::kDielectricF0;
}

/// Phong's highlight from roughness, metallic and KHR_materials_specular; docs/method/display.md.
/// One value per material: of the metallic-roughness texture the mean counts, of others the factor.
void set_highlight(const GltfReader& reader, const tinygltf::Material& in, scene::Material& m) {
  if (m.unlit) return;
  double weight = 1;
  Rgb color{1, 1, 1};
  if (const auto it = in.extensions.find("KHR_materials_specular"); it != in.extensions.end()) {
    weight = number_in(it->second, "specularFactor", 1);
    color = vec3_in(it->second, "specularColorFactor", color);
  }
  const scene::Scene& scene = reader.out.scene;
  const float metallic = m.metallic * mean_channel(scene, m.metallic_texture, 2);
  const float roughness = m.roughness * mean_channel(scene, m.metallic_texture, 1);
  const Rgb dielectric = min(color * dielectric_f0(in), Rgb{1, 1, 1}) * float(weight);
  const Rgb f0 = dielectric * (1 - metallic) + m.base_color * metallic;
  m.sharpness = scene::sharpness_of(roughness);
  m.specular = scene::specular_of(f0, m.sharpness);
}

/// A texture that an extension names, of which tinygltf knows nothing; index -1 where there is
/// none.
Result<tinygltf::TextureInfo> texture_in(const GltfReader& reader, const tinygltf::Value& extension,
                                         const char* key, const std::string& user) {
  tinygltf::TextureInfo info;
  if (!extension.IsObject() || !extension.Has(key)) return info;
  const tinygltf::Value& value = extension.Get(key);
  const double index = number_in(value, "index", -1), set = number_in(value, "texCoord", 0);
  if (!(index >= 0 && index < double(reader.model.textures.size())) || !(set >= 0 && set < 1e6))
    return fail(ErrorCode::bad_input,
                "{}: {} of {} has texture index {}, but there are {} textures", reader.source.name,
                key, user, index, reader.model.textures.size());
  info.index = int(index), info.texCoord = int(set);
  if (value.Has("extensions") && value.Get("extensions").IsObject())
    for (const std::string& name : value.Get("extensions").Keys())
      info.extensions[name] = value.Get("extensions").Get(name);
  return info;
}

Status read_diffuse_transmission(GltfReader& reader, Pictures& pictures,
                                 const tinygltf::Material& in, const std::string& user,
                                 scene::Material& out) {
  const auto it = in.extensions.find("KHR_materials_diffuse_transmission");
  if (it == in.extensions.end()) return {};
  out.diffuse_transmission = float(number_in(it->second, "diffuseTransmissionFactor", 0));
  if (!(out.diffuse_transmission > 0)) return {};
  out.diffuse_transmission_color =
      vec3_in(it->second, "diffuseTransmissionColorFactor", out.diffuse_transmission_color);
  LUXEL_TRY(const tinygltf::TextureInfo share,
            texture_in(reader, it->second, "diffuseTransmissionTexture", user));
  LUXEL_TRY(out.diffuse_transmission_texture, read_ref(reader, pictures, share, user, kNotClear));
  if (is_lost(share, out.diffuse_transmission_texture)) out.diffuse_transmission = 0;
  LUXEL_TRY(const tinygltf::TextureInfo color,
            texture_in(reader, it->second, "diffuseTransmissionColorTexture", user));
  LUXEL_TRY(out.diffuse_transmission_color_texture,
            read_ref(reader, pictures, color, user, kColorInstead));
  return {};
}

/// Light does without normal maps: one that cannot be read is left out.
void read_normal_map(GltfReader& reader, Pictures& pictures, const tinygltf::NormalTextureInfo& in,
                     const std::string& user, scene::Material& out) {
  tinygltf::TextureInfo info;
  info.index = in.index, info.texCoord = in.texCoord, info.extensions = in.extensions;
  const Result<TextureRef> ref = read_ref(reader, pictures, info, user, kNoBumps);
  if (!ref) {
    reader.warn("the normal map of {} is left out: {}", user, ref.error().message);
    return;
  }
  out.normal_texture = *ref, out.normal_scale = float(in.scale);
}

Result<scene::Material> read_material(GltfReader& reader, Pictures& pictures, size_t index) {
  const tinygltf::Material& in = reader.model.materials[index];
  const auto& pbr = in.pbrMetallicRoughness;
  const std::string user = label("material", index, in.name);
  scene::Material out;
  out.name = in.name;
  out.base_color = vec3_of(pbr.baseColorFactor, {1, 1, 1});
  out.alpha = pbr.baseColorFactor.size() > 3 ? float(pbr.baseColorFactor[3]) : 1.0f;
  out.metallic = float(pbr.metallicFactor);
  out.roughness = float(pbr.roughnessFactor);
  out.alpha_mode = alpha_mode_of(in.alphaMode);
  out.alpha_cutoff = float(in.alphaCutoff);
  out.double_sided = in.doubleSided;
  out.unlit = in.extensions.count("KHR_materials_unlit") > 0;
  // An unlit material is its base colour; the exporter's metallic factor means nothing then.
  if (out.unlit) out.metallic = 0;

  double strength = 1;
  if (const auto it = in.extensions.find("KHR_materials_emissive_strength");
      it != in.extensions.end())
    strength = number_in(it->second, "emissiveStrength", 1);
  out.emission = vec3_of(in.emissiveFactor, {}) * float(strength);

  if (const auto it = in.extensions.find("KHR_materials_transmission"); it != in.extensions.end()) {
    out.transmission = float(number_in(it->second, "transmissionFactor", 0));
    LUXEL_TRY(const tinygltf::TextureInfo info,
              texture_in(reader, it->second, "transmissionTexture", user));
    LUXEL_TRY(out.transmission_texture, read_ref(reader, pictures, info, user, kNotClear));
    if (is_lost(info, out.transmission_texture)) out.transmission = 0;
  }
  LUXEL_TRY_STATUS(read_diffuse_transmission(reader, pictures, in, user, out));
  const bool has_holes = out.alpha_mode != scene::AlphaMode::opaque;
  LUXEL_TRY(out.base_color_texture, read_ref(reader, pictures, pbr.baseColorTexture, user,
                                             has_holes ? kNoHoles : kColorInstead));
  if (is_lost(pbr.baseColorTexture, out.base_color_texture) && !states_color(reader, index))
    out.base_color = default_material().base_color;
  if (max_component(out.emission) > 0) {
    LUXEL_TRY(out.emission_texture, read_ref(reader, pictures, in.emissiveTexture, user, kNoGlow));
    if (is_lost(in.emissiveTexture, out.emission_texture)) out.emission = {};  // where is not known
  }
  if (out.metallic > 0) {
    const tinygltf::TextureInfo& metallic = pbr.metallicRoughnessTexture;
    LUXEL_TRY(out.metallic_texture, read_ref(reader, pictures, metallic, user, kNoMetal));
    if (is_lost(metallic, out.metallic_texture)) out.metallic = 0;
  }
  read_normal_map(reader, pictures, in.normalTexture, user, out);
  set_highlight(reader, in, out);
  return out;
}

void warn_about_metals(GltfReader& reader) {
  std::string names;
  size_t count = 0;
  for (size_t i = 0; i < reader.out.scene.materials.size(); ++i) {
    const scene::Material& m = reader.out.scene.materials[i];
    if (m.metallic < 1 || m.metallic_texture.texture != scene::kNone) continue;
    if (++count <= 5) names += (count > 1 ? ", " : "") + label("material", i, m.name);
  }
  if (count > 0)
    reader.warn(
        "{} materials are fully metallic (glTF's default) and reflect no diffuse light: {}{}",
        count, names, count > 5 ? ", ..." : "");
}

}  // namespace

double number_in(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

Vec2 vec2_in(const tinygltf::Value& object, const char* key, Vec2 fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() < 2) return fallback;
  const tinygltf::Value &x = value.Get(0), &y = value.Get(1);
  if (!x.IsNumber() || !y.IsNumber()) return fallback;
  return {float(x.GetNumberAsDouble()), float(y.GetNumberAsDouble())};
}

Rgb vec3_in(const tinygltf::Value& object, const char* key, Rgb fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() < 3) return fallback;
  std::array<float, 3> c{};
  for (size_t k = 0; k < 3; ++k) {
    if (!value.Get(k).IsNumber()) return fallback;
    c[k] = float(value.Get(k).GetNumberAsDouble());
  }
  return {c[0], c[1], c[2]};
}

Status read_materials(GltfReader& reader) {
  Pictures pictures{reader.source, reader.out};
  for (size_t i = 0; i < reader.model.materials.size(); ++i) {
    LUXEL_TRY(scene::Material material, read_material(reader, pictures, i));
    const std::string user = label("material", i, material.name);
    reader.first_set.push_back(choose_first_set(reader, user, material));
    reader.out.scene.materials.push_back(std::move(material));
  }
  warn_about_metals(reader);
  return {};
}

}  // namespace luxel::import
