// The scene with its lightmap, as one binary glTF file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/result.h"
#include "luxel/export/attach.h"
#include "luxel/image/codec.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// The light of some of the lights. Layers add up to the lightmap.
struct LightmapLayer {
  std::string name;
  std::vector<std::string> lights;          ///< that it is of
  std::vector<uint32_t> instances;          ///< whose surfaces shine in its light
  bool surroundings = false;                ///< background and environment are of it
  std::span<const image::Image> lightmaps;  ///< E, 4 channels, one for each page
};

/// glTF 2.0 binary: every instance becomes a node with a mesh of its own (its place in the atlas is
/// its own), TEXCOORD_1 holds the lightmap coordinates, vertices are split where charts part and
/// shared elsewhere; positions, normals, TEXCOORD_0, colours, materials, textures, lights and
/// cameras are kept. The lightmap is attached as extension MOZ_lightmap of every material (texCoord
/// 1, `intensity`), its picture an 8-bit sRGB PNG of E / intensity; docs/format/bake.md describes
/// it. `lightmaps` is E, 4 channels, one for each page of the atlas. With several pages a material
/// has a version for each that it lies on, and a mesh that lies on several a primitive for each.
/// asset.extras.luxel.layers lists `layers`, each with a texture per page and its own intensity
/// (without pictures: none), and nodes that shine name theirs in extras.luxel.layer. Passes the
/// Khronos validator without errors.
Result<std::vector<std::byte>> baked_glb(const scene::Scene& scene, const atlas::Atlas& atlas,
                                         std::span<const image::Image> lightmaps,
                                         std::span<const LightmapLayer> layers = {});
/// baked_glb() of an atlas of one page, without layers.
inline Result<std::vector<std::byte>> baked_glb(const scene::Scene& scene,
                                                const atlas::Atlas& atlas,
                                                const image::Image& lightmap) {
  return baked_glb(scene, atlas, std::span(&lightmap, 1));
}

/// Light that surfaces send to the eye, as pictures for viewers that know no lightmap.
struct LitPictures {
  Attach attach = Attach::combined;  ///< or emissive
  std::vector<image::Image8> pages;  ///< sRGB, per page; combined: the fourth channel is alpha
  int scale = 1;                     ///< pixels per texel of the lightmap, along a side
  float exposure = 1;                ///< the factor on radiance [1 / (W/(sr m^2))] in the pictures
  float strength = 1;                ///< emissive: exposed radiance = strength * linear(picture)
};

/// As baked_glb(), with materials that show `pictures` by their TEXCOORD_1, however they are lit:
/// combined as the base colour of KHR_materials_unlit, emissive as emission of black surfaces.
/// Vertex colours, normal maps and base colour textures are left out, since the pictures hold them.
/// Alpha modes, sides and materials that the scene has unlit stay in both.
Result<std::vector<std::byte>> lit_glb(const scene::Scene& scene, const atlas::Atlas& atlas,
                                       const LitPictures& pictures);

/// Name of a page's files, up to their extension: "lightmap", or of several pages "lightmap-0",
/// "lightmap-1", ... Those of a layer: "lightmap-LAYER", "lightmap-LAYER-0", ...
std::string lightmap_name(size_t page, size_t pages, std::string_view layer = {});

/// The lightmaps that a file of baked_glb() names: per material the file with its light,
/// "lightmap.exr"; "" where it names none. Error (bad_input): no .glb.
Result<std::vector<std::string>> lightmap_files_of(std::span<const std::byte> glb,
                                                   const std::string& name);
/// The way in which such a file shows its light. Error (bad_input): no .glb.
Result<Attach> attach_of(std::span<const std::byte> glb, const std::string& name);

/// A scene whose meshes carry light per vertex: `colors` is E / `intensity`, times the vertex
/// colours that the materials had. Materials become unlit (KHR_materials_unlit), so that every
/// viewer shows base colour times light.
Result<std::vector<std::byte>> vertex_lit_glb(const scene::Scene& scene, float intensity);

/// A scene without a lightmap as .glb (meshes shared by instances stay shared): how the procedural
/// scenes are written to scenes/.
Result<std::vector<std::byte>> scene_glb(const scene::Scene& scene);

/// The layers that a baked.glb names.
struct FileLayers {
  struct Layer {
    std::string name;
    bool surroundings = false;  ///< the light of background and environment is in it
  };
  std::vector<Layer> layers;
  /// Per node with a mesh, in the file's order, the layer that it shines in; layers.size(): none.
  std::vector<size_t> shines_in;
};
/// Errors: no glTF.
Result<FileLayers> layers_of(std::span<const std::byte> glb, const std::string& name);

}  // namespace luxel::export_
