// Places of a scene in the coordinates of its file, and back (Scene::origin).
#pragma once

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Where a place of the scene is in the world of its file [m].
inline DVec3 in_world(DVec3 origin, Vec3 p) {
  // A sum with 0 would make 0 of -0.
  const auto sum = [](double a, double b) { return b == 0 ? a : a + b; };
  const DVec3 q = to_double(p);
  return {sum(q.x, origin.x), sum(q.y, origin.y), sum(q.z, origin.z)};
}
inline DVec3 in_world(const Scene& scene, Vec3 p) { return in_world(scene.origin, p); }

/// The coordinates in the scene of a place in the world of its file [m].
inline Vec3 in_scene(const Scene& scene, DVec3 p) { return to_float(p - scene.origin); }

/// The double of the fewest digits that tells one coordinate in the world of the file: less
/// `origin` it is `value` again.
double short_number(float value, double origin = 0);

}  // namespace luxel::scene
