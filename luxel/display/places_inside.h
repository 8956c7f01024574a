// Places in a scene from which a camera may look around. For this room only.
#pragma once

#include <vector>

#include "luxel/display/direct_glimpse.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::display {

/// A place in the air.
struct PlaceInside {
  Vec3 eye;
  double around = 0;  ///< share of all directions in which surfaces are seen
  double above = 0;   ///< the same of directions that rise by more than 30 degrees
  double lit = 0;     ///< share of what is seen that gets light from lights or surroundings
  std::vector<SeenSide> seen;  ///< what of surfaces is in these directions
};

/// True where a place lies in a room: surfaces on nearly all sides, and a roof above.
bool is_enclosed(const PlaceInside& place);
/// True where light falls on enough of what the place sees.
bool is_lit(const PlaceInside& place);

/// Places spread evenly through the scene's bounds, each moved to eye level above what is under it;
/// none inside of solids. The same for the same scene.
std::vector<PlaceInside> places_inside(const scene::Scene& scene, const trace::RayTracer& tracer,
                                       const Glimpse& glimpse);

/// Places between the buildings of a town, where a person could stand: at eye level above open
/// ground, with walls in sight. None where the scene is no town: fewer than four buildings stand
/// apart, or buildings or open ground cover less than 15 % of its bounds.
std::vector<PlaceInside> places_in_streets(const scene::Scene& scene,
                                           const trace::RayTracer& tracer, const Glimpse& glimpse);

}  // namespace luxel::display
