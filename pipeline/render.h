// A picture of a bake or, by path tracing, of the scene itself: what `luxel render` does.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "base/vec.h"
#include "pipeline/settings.h"

namespace luxel::pipeline {

struct RenderSettings {
  std::filesystem::path scene;         ///< for its cameras and background
  std::filesystem::path from;          ///< folder of a bake: baked.glb and lightmap.exr are read
  std::filesystem::path output;        ///< .png (tone-mapped) or .exr (radiance)
  std::string technique = "lightmap";  ///< or "path", which needs no bake
  std::string camera;                  ///< by name; empty: the first, else a fitted one
  std::optional<Vec3> eye;
  Vec3 look_at{};
  double fov_deg = 45;
  int width = 960, height = 720;
  OutsideLight outside;
  int samples = 64;   ///< path: paths per pixel
  int bounces = -1;   ///< path: reflections between surfaces; < 0: all
  uint64_t seed = 1;  ///< path
};

struct Rendered {
  int width = 0, height = 0;
  uint64_t rays = 0;  ///< path
  double relative_error =
      0;  ///< path: root mean square of the pixels' standard errors over the mean
  std::vector<std::string> warnings;
};

/// Errors: settings out of range, no such camera, a folder without a bake, a lightmap that does not
/// fit the scene.
Result<Rendered> render(const RenderSettings& settings, Progress& progress);

}  // namespace luxel::pipeline
