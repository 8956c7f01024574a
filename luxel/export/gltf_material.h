// Materials and textures as glTF.
#pragma once

#include <array>
#include <map>
#include <tuple>

#include "luxel/export/glb.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// The texture coordinates that a primitive has for its material's textures: for the scene's UV
/// sets 0 and 1 the number n of TEXCOORD_n, or -1. Where there are none the scene's texture is
/// white, and glTF wants no texture at all.
using TexcoordSlots = std::array<int, 2>;

/// What is already in the document: materials, textures and samplers are written when first used.
struct MaterialBook {
  std::map<std::tuple<uint32_t, TexcoordSlots, uint32_t>, size_t> materials;
  std::map<uint32_t, size_t> images;
  std::map<std::array<int, 4>, size_t> samplers;     ///< wrap u, wrap v, magnify, minify
  std::map<std::array<size_t, 2>, size_t> textures;  ///< image, sampler
  /// What every material says of the lightmap, for each of its pages; empty: there is none.
  struct LightmapPage {
    nlohmann::json extension;  ///< MOZ_lightmap
    std::string name;          ///< of the files, without what follows the first dot
  };
  std::vector<LightmapPage> lightmap;
};

/// The index of the material in the document, as it is on a page of the lightmap (0 without one).
size_t material_index(Glb& glb, MaterialBook& book, const scene::Scene& scene, uint32_t material,
                      TexcoordSlots slots, uint32_t page);

/// A lightmap picture as glTF texture: clamped, bilinear, without mipmaps (charts would bleed).
size_t append_lightmap_texture(Glb& glb, MaterialBook& book, std::span<const std::byte> png,
                               const std::string& name);

}  // namespace luxel::export_
