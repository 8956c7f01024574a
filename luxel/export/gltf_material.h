// Materials and textures as glTF.
#pragma once

#include <array>
#include <map>
#include <tuple>

#include "luxel/export/attach.h"
#include "luxel/export/glb.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// The texture coordinates that a primitive has for its material's textures: for the scene's UV
/// sets 0 and 1 the number n of TEXCOORD_n, or -1. Where there are none the scene's texture is
/// white, and glTF wants no texture at all.
using TexcoordSlots = std::array<int, 2>;

/// Where a material is used.
struct MaterialPlace {
  uint32_t page = 0;     ///< of the lightmap; 0 without one
  bool attached = true;  ///< false: on what shows no lightmap, though it has a place there
};

/// Parts that the document has already: materials, textures and samplers are written when first
/// used.
struct MaterialBook {
  std::map<std::tuple<uint32_t, TexcoordSlots, uint32_t, bool>, size_t> materials;
  std::map<uint32_t, size_t> images;
  std::map<std::array<int, 4>, size_t> samplers;     ///< wrap u, wrap v, magnify, minify
  std::map<std::array<size_t, 2>, size_t> textures;  ///< image, sampler
  /// The lightmap that materials refer to, page by page; empty: there is none.
  struct LightmapPage {
    nlohmann::json picture;  ///< MOZ_lightmap itself, else the textureInfo of what is attached
    std::string name;        ///< of the files, without what follows the first dot
  };
  std::vector<LightmapPage> lightmap;
  Attach attach = Attach::lightmap;
  float strength = 1;  ///< emissive: the radiance of white
  /// Combined and emissive: the scene's materials without what the pictures hold already. Empty:
  /// they are as in the scene.
  std::vector<scene::Material> shown;
};

/// The material as the document has it.
inline const scene::Material& shown_material(const MaterialBook& book, const scene::Scene& scene,
                                             uint32_t material, MaterialPlace place) {
  return book.shown.empty() || !place.attached ? scene.materials[material] : book.shown[material];
}

/// True where the book's pictures hold the colour of a material's surfaces, vertex colours
/// included.
inline bool is_in_pictures(const MaterialBook& book, const scene::Material& material,
                           MaterialPlace place) {
  return place.attached && !book.lightmap.empty() && book.attach != Attach::lightmap &&
         !material.unlit;
}

/// MaterialBook::shown. Unlit materials stay as they are; of others there remain names, sides and
/// alpha, which is in the pictures, too, where they are `combined`. Glass of
/// KHR_materials_transmission becomes a blended surface: what has no colour of its own tints
/// nothing.
std::vector<scene::Material> materials_without_light(const scene::Scene& scene, Attach attach);

/// The index of the material in the document, as it is in that place.
size_t material_index(Glb& glb, MaterialBook& book, const scene::Scene& scene, uint32_t material,
                      TexcoordSlots slots, MaterialPlace place);

/// A picture on the lightmap's charts as glTF texture: clamped and bilinear. Without mipmaps charts
/// do not bleed; a picture that is finer than the lightmap would flicker without.
size_t append_lightmap_texture(Glb& glb, MaterialBook& book, std::span<const std::byte> png,
                               const std::string& name, bool mipmaps = false);

}  // namespace luxel::export_
