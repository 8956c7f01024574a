// Finds the part of an edited scene that the pointer is on.
#pragma once

#include <optional>

#include "luxel/view/edit/edits.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

/// The first hit of a ray in the scene as it is now, as trace::visible_hits(): the back faces of
/// one-sided materials are invisible. Triangles of instances that have moved are tried one by one:
/// some milliseconds for a million of them.
trace::Hit visible_now(const EditDesk& desk, const trace::Ray& ray);

/// surface_seen() of the scene as it is now.
std::optional<scene::SurfacePoint> surface_seen_now(const EditDesk& desk, const Frame& frame,
                                                    Vec2 pixel, int width, int height);

/// The box around a mesh that is placed so [m].
Box3 placed_bounds(const scene::Mesh& mesh, const Mat34& world_from_object);
/// The box around an instance's mesh before it is placed [m].
Box3 object_bounds(const scene::Scene& scene, uint32_t instance);

}  // namespace luxel::view
