// Meshes of a scene that are stored once for all their instances.
#pragma once

#include <cstddef>
#include <vector>

#include "luxel/scene/scene.h"

namespace luxel::trace {

/// Drawn triangles above which meshes are shared between instances.
inline constexpr size_t kMaxFlatTriangles = size_t(1) << 20;

/// Per mesh: whether it is stored once, which those with several instances are in large scenes.
std::vector<bool> shared_meshes(const scene::Scene& scene, size_t max_flat_triangles);

/// True where rays can be taken into the space of a mesh with this transform, which may not press
/// it flat.
bool can_be_undone(const Mat34& world_from_object);

}  // namespace luxel::trace
