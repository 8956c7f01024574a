// Cameras of procedural scenes.
#pragma once

#include <string>

#include "luxel/scene/scene.h"

namespace luxel::scene {

/// Adds a perspective camera at `eye`, upright, with `target` in the middle of its picture.
/// `aspect` as in Camera.
void place_camera(Scene& scene, std::string name, Vec3 eye, Vec3 target, float fov_y_rad,
                  float aspect = 0);

}  // namespace luxel::scene
