// Where light may have changed because something moved: which boxes lie between places and lights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/vec.h"
#include "luxel/light/lights.h"
#include "luxel/scene/scene.h"
#include "luxel/transport/elements.h"

namespace luxel::light {

/// True where some segment from a point of `from` to a point of `to` meets `box` [m]. The segments
/// sweep a volume: at the parameter t they fill the box {(1 - t) p + t q}, whose sides move evenly.
/// Per axis it overlaps `box` in an interval of t, between the roots of two linear functions; some
/// segment meets the box where the three intervals have a t in [0, 1] in common, and only there,
/// but for a margin of rounding. False where one of the three is empty.
bool may_cross(const Box3& from, const Box3& to, const Box3& box);
/// Light from infinitely far may cross the box: rays from `from` along any direction within the
/// cone of half-angle `angular_radius_rad` about `towards` (unit). Never false where a ray meets
/// the box; the cone counts as the box around its directions.
bool may_cross(const Box3& from, Vec3 towards, float angular_radius_rad, const Box3& box);

/// Per element: 1 where light from some punctual light, emissive triangle or bright texel of the
/// environment may cross one of `boxes` [m, world] on its way to within `radius_m` of the element.
/// Lights that bring nothing there because of how they are turned count as well; those of no power
/// and lights out of range do not.
std::vector<uint8_t> elements_in_reach(const scene::Scene& scene,
                                       const transport::Elements& elements,
                                       std::span<const float> radius_m, const Lights& lights,
                                       std::span<const Box3> boxes);

}  // namespace luxel::light
