// The camera that a picture is taken with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/image/image.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

struct CameraChoice {
  /// interior, exterior, front or top (display::Viewpoint), or a camera of the scene; before
  /// `name`.
  std::string view = {};
  std::string name = {};          ///< of a camera of the scene; empty: the first, else a fitted one
  std::optional<DVec3> eye = {};  ///< in the world of the file; instead of a camera of the scene
  DVec3 look_at{};
  double fov_deg = 45;
  float aspect = 4.0f / 3;         ///< of the picture
  std::string asked = "--camera";  ///< what messages call the choice of a name
};

/// The words of --view, with "or" before the last.
std::string viewpoint_names();

/// Ok where `view` is empty, a word of --view or a camera of the scene; else an error, which calls
/// the scene `file`.
Status check_view(const std::string& view, const scene::Scene& scene, const std::string& file);

/// The hits of a coarse grid of rays: first of all, and when the backs of one-sided materials are
/// invisible.
struct Outlook {
  std::vector<trace::Hit> first, seen;
};
Outlook outlook_of(const scene::Scene& scene, const trace::RayTracer& tracer,
                   const scene::Camera& camera, float aspect);

/// `file` is what messages call the scene. A camera of the file that nobody asked for and that
/// shows no surface, or a wall right before it, gives way to a fitted one; `warnings` gets a
/// sentence then. Errors: no such camera, one that looks nowhere.
Result<scene::Camera> choose_camera(const CameraChoice& choice, const scene::Scene& scene,
                                    const trace::RayTracer& tracer, const std::string& file,
                                    std::vector<std::string>* warnings = nullptr);

/// Errors: a pixel of a picture of the scene has more light than can be held (scene::check_held).
Status check_picture(const scene::Scene& scene, const trace::RayTracer& tracer,
                     const scene::Camera& camera, const image::Image& picture);

}  // namespace luxel::pipeline
