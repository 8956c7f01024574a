// Cuts triangles of a mesh along planes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/plane.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {

/// A plane of the world for points of object space. Its normal is not a unit vector: heights stay
/// those of the world.
Plane plane_in_object(const Plane& world, const Mat34& world_from_object);

/// The mesh of an instance, which gets one of its own where it shares it.
Mesh& own_mesh(Scene& scene, uint32_t instance);

/// Cuts every triangle with `chosen[t]` != 0 that the plane crosses into pieces on either side of
/// it. A triangle that is not chosen but shares a cut edge is divided there too, so that no edge
/// ends on the middle of another. Vertices at heights up to `tolerance` count as lying on the plane
/// and are not moved. Attributes of new vertices are interpolated; equal positions stay equal, bit
/// for bit, whichever triangle asks.
///
/// A divided triangle's first piece stays where it was, the others are appended. Returns, per
/// appended triangle, the one it was a part of; `chosen` has an entry per triangle.
std::vector<uint32_t> cut_mesh(Mesh& mesh, std::span<const uint8_t> chosen, const Plane& plane,
                               double tolerance);

}  // namespace luxel::scene
