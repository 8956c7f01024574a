// Moves of a viewer's camera: around a place, aside, nearer, through the air.
//
// Angles are in radians and places in the world's metres. A camera's scale counts for nothing
// (trace::CameraRays); each move returns one whose axes are of unit length.
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::view {

/// Turned around `target`: by `aside` about the world's vertical, counter-clockwise from above, and
/// by `up` towards the zenith. It never turns over: what would lean it further than 89 degrees from
/// the horizon is left out. A camera that is rolled keeps its roll.
scene::Camera orbited(const scene::Camera& camera, Vec3 target, float aside, float up);

/// Turned where it stands, as one turns the head; signs and limits as in orbited().
scene::Camera turned(const scene::Camera& camera, float aside, float up);

/// Moved in its own plane so that a point which lies `target`'s distance ahead moves by `by` in the
/// picture, x to the right and y down, in parts of the picture's height.
scene::Camera panned(const scene::Camera& camera, Vec3 target, Vec2 by, float aspect);

/// Moved so that `place` keeps its place in the picture and is at `factor` times its distance; what
/// is parallel shows `factor` times as much. `factor` > 0.
scene::Camera approached(const scene::Camera& camera, Vec3 place, float factor);

/// Moved along its own axes: right, up (the world's), ahead [m].
scene::Camera flown(const scene::Camera& camera, Vec3 right_up_ahead);

/// Looking in the same direction, so far away that a ball around the box just fits into a picture
/// of this aspect (width / height).
scene::Camera framed(const scene::Camera& camera, const Box3& box, float aspect);

}  // namespace luxel::view
