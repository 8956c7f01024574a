// A picture of a scene by one of several techniques, or a sheet of all of them: what `luxel render`
// does.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/vec.h"
#include "luxel/display/lines.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/render/exposure.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/texels/solve_input.h"

namespace luxel::pipeline {

/// The name that stands for a contact sheet of all techniques.
inline constexpr std::string_view kAllTechniques = "all";

inline constexpr int kDefaultPathSamples = 64;

/// Unset members have defaults. A member that is set and means nothing to the technique is an
/// error.
struct RenderSettings {
  std::filesystem::path scene;   ///< what is drawn; for a bake its cameras and background
  std::filesystem::path from;    ///< folder of a bake: baked.glb and lightmap.exr are read
  std::filesystem::path output;  ///< .png (display values), .exr or .hdr (radiance)
  std::string technique =
      "lightmap";            ///< a name of luxel/pipeline/render/techniques.h, or kAllTechniques
  std::string camera;        ///< by name; empty: the first, else a fitted one
  std::string view;          ///< instead: CameraChoice::view
  std::optional<DVec3> eye;  ///< in the world of the file
  DVec3 look_at{};
  double fov_deg = 45;
  int width = 960, height = 720;  ///< of a contact sheet: each tile's
  import::ImportParams reading;
  OutsideLight outside;
  std::optional<Exposure> exposure;                  ///< automatic for light, 0 stops for colours
  std::optional<display::ToneMap> tone_map;          ///< shoulder for light, clamp for colours
  std::optional<int> samples;                        ///< paths per pixel, 64
  std::optional<int> bounces;                        ///< reflections between surfaces; < 0: all, -1
  std::optional<uint64_t> seed;                      ///< 1
  std::optional<hemicube::HemicubeParams> hemicube;  ///< radiosity
  std::optional<HierarchicalSettings> hierarchical;  ///< flat, gouraud, ...
  std::vector<std::string> overlays;  ///< the same; names of luxel/pipeline/render/overlays.h
};

/// Report on a drawn picture.
struct Rendered {
  int width = 0, height = 0;
  float exposure = 1;  ///< the factor that light was shown with
  uint64_t rays = 0;   ///< path
  double relative_error =
      0;  ///< path: root mean square of the pixels' standard errors over the mean
  std::vector<std::string> tiles;  ///< of a contact sheet: the techniques, in reading order
  std::vector<std::string> warnings;
  std::string device;                  ///< BakeDevice::name, if it took part
  std::vector<display::Line> overlay;  ///< to be drawn over the picture
};

/// `device` takes part in techniques that leave something to one; null: the processor alone.
/// Errors: settings out of range or without meaning for the technique, a device too, unless it is
/// optional; no such camera, a folder without a bake, a lightmap that does not fit the scene; those
/// of the device.
Result<Rendered> render(const RenderSettings& settings, Progress& progress,
                        const BakeDevice* device = nullptr);

}  // namespace luxel::pipeline
