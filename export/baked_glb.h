// The scene with its lightmap, as one binary glTF file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "atlas/atlas.h"
#include "base/result.h"
#include "image/image.h"
#include "scene/scene.h"

namespace luxel::export_ {

/// glTF 2.0 binary: every instance becomes a node with a mesh of its own (its place in the atlas is
/// its own), TEXCOORD_1 holds the lightmap coordinates, vertices are split where charts part and
/// shared elsewhere; positions, normals, TEXCOORD_0, colours, materials, textures, lights and
/// cameras are kept. The lightmap is attached as extension MOZ_lightmap of every material (texCoord
/// 1, `intensity`), its picture an 8-bit sRGB PNG of E / intensity; docs/bake.md describes it.
/// `lightmap` is E, 4 channels. Passes the Khronos validator without errors.
Result<std::vector<std::byte>> baked_glb(const scene::Scene& scene, const atlas::Atlas& atlas,
                                         const image::Image& lightmap);

/// A scene whose meshes carry light per vertex: `colors` is E / `intensity`, times the vertex
/// colours that the materials had. Materials become unlit (KHR_materials_unlit), so that every
/// viewer shows base colour times light.
Result<std::vector<std::byte>> vertex_lit_glb(const scene::Scene& scene, float intensity);

/// A scene without a lightmap as .glb (meshes shared by instances stay shared): how the procedural
/// scenes are written to scenes/.
Result<std::vector<std::byte>> scene_glb(const scene::Scene& scene);

}  // namespace luxel::export_
