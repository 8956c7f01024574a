// A scene of any size.
#pragma once

#include "luxel/scene/procedural.h"

namespace luxel::testing_support {

/// Few things, so that every solver is fast: the box without its blocks, and lamps besides its own.
inline scene::Scene box_with_lamps() {
  scene::Scene box = scene::cornell_box(scene::CornellColors::pbrt, false);
  scene::PunctualLight lamp{"bulb", scene::PunctualLight::Kind::point, {0.1f, 0.1f, 0.1f}};
  lamp.position = {0.1f, 0.4f, 0.3f};
  box.lights.push_back(lamp);
  lamp.name = "spot", lamp.kind = scene::PunctualLight::Kind::spot;
  lamp.position = {0.4f, 0.5f, 0.1f}, lamp.direction = {0, -1, 0}, lamp.range_m = 0.625f;
  box.lights.push_back(lamp);
  return box;
}

/// A scene in another unit of length. Lamps need the square of it to be as bright.
inline scene::Scene scaled(scene::Scene scene, float factor) {
  for (scene::Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p *= factor;
  for (scene::PunctualLight& light : scene.lights) {
    light.position *= factor, light.range_m *= factor;
    light.intensity *= factor * factor;
  }
  for (scene::Camera& camera : scene.cameras)
    for (auto& row : camera.world_from_camera.row) row[3] *= factor;
  return scene;
}

}  // namespace luxel::testing_support
