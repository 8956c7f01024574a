// Light at one point: how much, where it comes from, and what hides the rest. What `luxel probe`
// does. [Hardt96, appendices B.4.9 and B.4.10]
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/pipeline/solver/hierarchical.h"

namespace luxel::pipeline {

/// What `luxel probe` is asked for.
struct ProbeSettings {
  std::filesystem::path scene;
  Vec3 at{};                     ///< the nearest surface is looked at
  std::optional<Vec3> normal;    ///< only surfaces that face about there
  std::filesystem::path output;  ///< a .png with the backprojections; empty: none
  import::ImportParams reading;
  OutsideLight outside;
  HierarchicalSettings hierarchical;
  int threads = 0;
};

/// A face that the point sees.
struct ProbedSource {
  std::string name;  ///< of its instance
  std::string material;
  double form_factor = 0;  ///< of the part that is seen
  double visible = 0;      ///< that over the form factor of the whole
  Rgb irradiance;          ///< what it brings [W/m^2]
};

/// What is known of the light at a point of a surface.
struct Probed {
  std::string name, material;  ///< of the surface
  Vec3 position{}, normal{};
  float distance_m = 0;               ///< from `at`
  Rgb exact, interpolated;            ///< E [W/m^2]
  Rgb punctual_and_background;        ///< the part of E that comes from no surface
  std::vector<ProbedSource> sources;  ///< the brightest first
  std::vector<std::string> warnings;
};

/// Errors: settings, no surface near the point, what the scene and the solver say.
Result<Probed> probe(const ProbeSettings& settings, Progress& progress);

}  // namespace luxel::pipeline
