// Materials and textures of the files that Assimp reads.
#include <assimp/scene.h>

#include <algorithm>
#include <cstring>

#include "luxel/import/assimp_parts.h"
#include "luxel/import/pictures.h"

namespace luxel::import {
namespace {

using scene::TextureRef;

struct Textures {
  const aiScene& in;
  Pictures pictures;
};

/// Uncompressed: mWidth x mHeight texels in the order b, g, r, a.
scene::Texture raw_texture(const aiTexture& in, const std::string& name) {
  scene::Texture texture;
  texture.name = name;
  texture.width = int(in.mWidth);
  texture.height = int(in.mHeight);
  for (size_t i = 0; i < size_t(in.mWidth) * in.mHeight; ++i) {
    const aiTexel& t = in.pcData[i];
    texture.rgba.insert(texture.rgba.end(), {t.r, t.g, t.b, t.a});
  }
  return texture;
}

Result<scene::Texture> load_texture(const Textures& textures, const std::string& path,
                                    const std::string& user) {
  const SourceFile& source = textures.pictures.source;
  const aiTexture* const embedded = textures.in.GetEmbeddedTexture(path.c_str());
  if (embedded == nullptr) return load_picture(source, path, user);
  if (embedded->mHeight != 0) return raw_texture(*embedded, path);
  std::vector<std::byte> encoded(embedded->mWidth);  // then its size in bytes
  std::memcpy(encoded.data(), embedded->pcData, encoded.size());
  LUXEL_TRY(scene::Texture texture,
            decode_texture(std::move(encoded), source.name + ": " + path, user, source.memory));
  texture.name = path;
  return texture;
}

scene::Wrap wrap_of(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return scene::Wrap::clamp;
  return mode == aiTextureMapMode_Mirror ? scene::Wrap::mirror : scene::Wrap::repeat;
}

/// The first texture of a kind. None: the material has none, or its picture is lost, and then
/// `lost` becomes true.
Result<TextureRef> read_ref(Textures& textures, const aiMaterial& in, aiTextureType type,
                            const std::string& user, std::string_view instead, bool& lost) {
  TextureRef ref;
  aiString path;
  unsigned uv_set = 0;
  aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (in.GetTexture(type, 0, &path, nullptr, &uv_set, nullptr, nullptr, modes) != aiReturn_SUCCESS)
    return ref;
  const auto load = [&] { return load_texture(textures, path.C_Str(), user); };
  LUXEL_TRY(ref.texture, picture_of(textures.pictures, path.C_Str(), instead, load));
  lost = ref.texture == scene::kNone;
  ref.uv_set = uv_set == 1 ? 1 : 0;
  ref.wrap_u = wrap_of(modes[0]);
  ref.wrap_v = wrap_of(modes[1]);
  return ref;
}

Rgb color_of(const aiMaterial& in, const char* key, unsigned type, unsigned index, Rgb fallback) {
  aiColor3D c;
  return in.Get(key, type, index, c) == aiReturn_SUCCESS ? Rgb{c.r, c.g, c.b} : fallback;
}

/// Assimp states a specular colour for Lambertian materials too, and makes up grey for Collada's.
bool has_highlight(const aiMaterial& in) {
  int model = aiShadingMode_Gouraud;
  in.Get(AI_MATKEY_SHADING_MODEL, model);
  return model == aiShadingMode_Phong || model == aiShadingMode_Blinn;
}

Result<scene::Material> read_material(Textures& textures, unsigned index) {
  const aiMaterial& in = *textures.in.mMaterials[index];
  aiString name;
  in.Get(AI_MATKEY_NAME, name);
  scene::Material out = default_material();
  // Assimp makes up a material for faces without one; in an .x file it has no name.
  if (std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME) == 0) return out;
  if (textures.pictures.source.extension == ".x" && name.length == 0) return out;
  out.name = name.C_Str();
  const std::string user = label("material", index, out.name);
  out.base_color = color_of(in, AI_MATKEY_COLOR_DIFFUSE, out.base_color);
  out.base_color = color_of(in, AI_MATKEY_BASE_COLOR, out.base_color);
  out.emission = color_of(in, AI_MATKEY_COLOR_EMISSIVE, {});
  if (has_highlight(in)) {
    float factor = 1;  // FBX's SpecularFactor, which Assimp leaves to us, unlike the others
    in.Get(AI_MATKEY_SHININESS_STRENGTH, factor);
    out.specular = color_of(in, AI_MATKEY_COLOR_SPECULAR, out.specular) * factor;
    in.Get(AI_MATKEY_SHININESS, out.sharpness);
  }
  in.Get(AI_MATKEY_METALLIC_FACTOR, out.metallic);
  in.Get(AI_MATKEY_OPACITY, out.alpha);
  if (out.alpha < 1) out.alpha_mode = scene::AlphaMode::blend;
  int two_sided = 0;
  in.Get(AI_MATKEY_TWOSIDED, two_sided);
  out.double_sided = two_sided != 0;

  bool no_color = false, no_glow = false;
  LUXEL_TRY(out.base_color_texture,
            read_ref(textures, in, aiTextureType_DIFFUSE, user, kColorInstead, no_color));
  if (out.base_color_texture.texture == scene::kNone && !no_color) {
    LUXEL_TRY(out.base_color_texture,
              read_ref(textures, in, aiTextureType_BASE_COLOR, user, kColorInstead, no_color));
  }
  LUXEL_TRY(out.emission_texture,
            read_ref(textures, in, aiTextureType_EMISSIVE, user, kNoGlow, no_glow));
  if (no_glow) out.emission = {};  // where is not known
  // A picture alone means the picture as it is.
  if (out.emission_texture.texture != scene::kNone && max_component(out.emission) <= 0)
    out.emission = {1, 1, 1};
  return out;
}

}  // namespace

Status read_assimp_materials(const aiScene& in, const SourceFile& source, Imported& out) {
  Textures textures{in, {source, out}};
  for (unsigned i = 0; i < in.mNumMaterials; ++i) {
    LUXEL_TRY(scene::Material material, read_material(textures, i));
    out.scene.materials.push_back(std::move(material));
  }
  return {};
}

}  // namespace luxel::import
