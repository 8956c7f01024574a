// From places to pixels, and from the pointer to places.
#pragma once

#include <optional>

#include "luxel/trace/ray_tracer.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {

/// Where a place lies in the picture, in pixels; none behind the eye.
std::optional<Vec2> pixel_of(const Walk& walk, Vec3 place);
/// The ray of sight through a pixel; its direction is of unit length.
trace::Ray ray_through(const Walk& walk, Vec2 pixel);
/// The camera's direction, of unit length.
Vec3 forward_of(const Walk& walk);
/// The size of a pixel at the distance of a place [m]; 0 behind the eye.
float metres_per_pixel(const Walk& walk, Vec3 place);

/// Where a ray meets the plane through `place` at a right angle to `normal`.
Vec3 on_plane(const trace::Ray& ray, Vec3 place, Vec3 normal);
/// The place of a line that comes nearest to a ray; `axis` is of unit length. The line's own place
/// where they are parallel.
Vec3 on_line(const trace::Ray& ray, Vec3 place, Vec3 axis);

}  // namespace luxel::view
