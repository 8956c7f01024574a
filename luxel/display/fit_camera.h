// Cameras for scenes that bring none.
#pragma once

#include <cstdint>

#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::display {

/// Where a camera looks from. `automatic`: from inside where the scene is a room, or a house of
/// rooms, that has light inside and cannot be looked into from outside; a town from a street; all
/// else from outside.
enum class Viewpoint : uint8_t { automatic, interior, exterior, front, top };

/// A camera that shows the scene well, in a picture of this aspect (width / height).
/// interior, exterior: of some candidates the one that shows the most front faces, and lit ones, of
/// the finest triangles; interior stands where surfaces are around it, or, in scenes without such a
/// place, where most are, or outside. front, top: orthographic, as in modelling programs, and the
/// whole scene is in the picture: front looks along -Z, which glTF calls the front of things, with
/// +Y up; top looks down, with -Z up.
scene::Camera fit_camera(const scene::Scene& scene, const trace::RayTracer& tracer, float aspect,
                         Viewpoint from = Viewpoint::automatic);

}  // namespace luxel::display
