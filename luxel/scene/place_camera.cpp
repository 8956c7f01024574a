#include "luxel/scene/place_camera.h"

#include <utility>

#include "luxel/scene/shapes.h"

namespace luxel::scene {

void place_camera(Scene& scene, std::string name, Vec3 eye, Vec3 target, float fov_y_rad,
                  float aspect) {
  scene.cameras.push_back({.name = std::move(name),
                           .world_from_camera = look_at(eye, target, {0, 1, 0}),
                           .fov_y_rad = fov_y_rad,
                           .aspect = aspect});
}

}  // namespace luxel::scene
