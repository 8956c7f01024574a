// The camera that a picture is taken with.
#pragma once

#include <optional>
#include <string>

#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

struct CameraChoice {
  std::string name;         ///< of a camera of the scene; empty: the first, else a fitted one
  std::optional<Vec3> eye;  ///< instead of a camera of the scene
  Vec3 look_at{};
  double fov_deg = 45;
  float aspect = 4.0f / 3;         ///< of the picture
  std::string asked = "--camera";  ///< what messages call the choice of a name
};

/// `file` is what messages call the scene. Errors: no such camera, one that looks nowhere.
Result<scene::Camera> choose_camera(const CameraChoice& choice, const scene::Scene& scene,
                                    const trace::RayTracer& tracer, const std::string& file);

}  // namespace luxel::pipeline
