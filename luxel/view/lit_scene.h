// A scene whose vertices know their places in the lightmap.
#pragma once

#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/scene/scene.h"

namespace luxel::view {

/// A scene as it is drawn while it is baked: what baked.glb would be, without the light.
struct LitScene {
  scene::Scene scene;  ///< a mesh per instance; a version of each material per page that it lies on
  std::vector<std::vector<Vec2>> light_uv;  ///< per mesh and vertex, in [0, 1] of its page
  std::vector<size_t> page_of_material;     ///< index into the atlas's pages
  std::vector<uint32_t> material_of_scene;  ///< per material, the one that it is a version of
};

/// Vertices are split where charts part. `scene` is what the atlas lays out.
LitScene lit_scene(const scene::Scene& scene, const atlas::Atlas& atlas);

}  // namespace luxel::view
