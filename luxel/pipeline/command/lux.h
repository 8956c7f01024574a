// Illuminance on work planes, in the light of a bake: what `luxel lux` does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/command/work_plane.h"
#include "luxel/pipeline/settings/light_unit.h"
#include "luxel/pipeline/settings/outside_light.h"

namespace luxel::pipeline {

/// Settings of `luxel lux`.
struct LuxSettings {
  std::filesystem::path scene;
  std::filesystem::path from;                  ///< folder of a bake
  std::vector<std::filesystem::path> outputs;  ///< .csv or .png each
  WorkPlaneParams plane;
  int samples = 1024;  ///< rays per point
  uint64_t seed = 1;
  import::ImportParams reading;  ///< of the scene's file
  OutsideLight outside;          ///< replaces that of the bake
  int threads = 0;
};

/// E over the points of a room. Points stand for equal areas.
struct RoomLight {
  size_t points = 0;
  double area_m2 = 0;
  double mean = 0, minimum = 0, maximum = 0;
  double standard_error = 0;  ///< of the mean
  double largest_error = 0;   ///< the largest standard error of a point
  Vec3 minimum_at{}, maximum_at{};

  /// U0 of EN 12464-1.
  double uniformity() const { return mean > 0 ? minimum / mean : 0; }
};

/// A floor's work plane with its light.
struct LitFloor {
  Floor floor;
  std::vector<float> illuminance, standard_error;  ///< luminance of E per point
  std::vector<RoomLight> rooms;                    ///< one per room of the floor
  RoomLight all;                                   ///< of all its points
};

struct LuxReport {
  std::vector<LitFloor> floors;  ///< those with points
  DVec3 origin;                  ///< Scene::origin, which places of floors are relative to
  LightUnit unit;
  uint64_t rays = 0;
  std::vector<std::string> warnings;
};

/// Errors: settings, files, no floor, no point.
Result<LuxReport> lux(const LuxSettings& settings, Progress& progress);

/// x,y,z,E,standard_error,floor,room: a line per point.
std::string lux_csv(const LuxReport& report);

}  // namespace luxel::pipeline
