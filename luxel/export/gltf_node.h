// Transforms, lights and cameras as glTF nodes.
#pragma once

#include "luxel/export/glb.h"
#include "luxel/scene/scene.h"

namespace luxel::export_ {

/// Appends `content` (mesh, camera, light and name, without a place) as a node at `world`, which
/// is relative to the origin of `glb`, and returns the index of the node that belongs into the
/// scene's list. A sheared or flattened place, which a glTF matrix may not have, becomes a node
/// inside another.
size_t append_node(Glb& glb, const Mat34& world, nlohmann::json content);

size_t append_light(Glb& glb, const scene::PunctualLight& light);

/// `near_m`, `far_m`: clipping planes; glTF asks for some, the scene knows none.
size_t append_camera(Glb& glb, const scene::Camera& camera, float near_m, float far_m);

}  // namespace luxel::export_
