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
#include "luxel/pipeline/settings/light_unit.h"
#include "luxel/pipeline/settings/outside_light.h"
#include "luxel/pipeline/solver/hierarchical.h"

namespace luxel::pipeline {

/// Method that finds the light at the point.
enum class ProbeMethod {
  paths,         ///< paths from the point, until they tell it well enough
  bake,          ///< rays from the point that end on the lightmaps of a bake
  hierarchical,  ///< closed forms of all faces that the point sees, in a scene that is solved first
};

/// Settings of `luxel probe`.
struct ProbeSettings {
  std::filesystem::path scene;
  std::filesystem::path from;  ///< folder of a bake, of ProbeMethod::bake
  ProbeMethod method = ProbeMethod::paths;
  DVec3 at{};                    ///< in the world of the file; the nearest surface is looked at
  std::optional<Vec3> normal;    ///< only surfaces that face about there
  bool in_air = false;           ///< `at` itself is looked at; facing `normal`, or up
  std::filesystem::path output;  ///< hierarchical: a .png with the backprojections; empty: none
  double max_error = 0.005;      ///< relative standard error at which rays are enough
  /// About when no more rays are begun; hierarchical: when there is no result, or one without
  /// refinement, as a warning says.
  double time_budget_s = 10;
  int most_rounds = 18;  ///< of rays, each twice the last: by default 2^30, more than it ever needs
  uint64_t seed = 1;
  import::ImportParams reading;
  OutsideLight outside;
  HierarchicalSettings hierarchical;
  int threads = 0;
};

/// A surface that the point sees: a face of ProbeMethod::hierarchical, else all of an instance's
/// that have one material.
struct ProbedSource {
  std::string name;  ///< of its instance
  std::string material;
  double form_factor = 0;         ///< of the part that is seen
  std::optional<double> visible;  ///< hierarchical: that over the form factor of the whole
  Rgb irradiance;                 ///< what it brings [W/m^2]
};

/// Light at a point of a surface, or in the air, with its errors and sources.
struct Probed {
  std::string name, material;  ///< of the surface; empty in the air
  DVec3 position{};            ///< in the world of the file
  Vec3 normal{};
  float distance_m = 0;               ///< from `at`
  Rgb irradiance;                     ///< E [W/m^2]
  Rgb standard_error;                 ///< of that, at most; hierarchical: by paths beside it
  float luminance_error = 0;          ///< standard error of the luminance of E
  std::optional<Rgb> interpolated;    ///< hierarchical: E of its light mesh; bake: of the lightmap
  Rgb punctual_and_background;        ///< the part of E that comes from no surface
  std::vector<ProbedSource> sources;  ///< the brightest first
  bool out_of_time = false;           ///< the time was over before max_error was reached
  LightUnit unit;
  std::vector<std::string> warnings;
};

/// A usual time_budget_s of ProbeMethod::hierarchical, which solves the whole scene.
inline constexpr double kUsualSecondsByFaces = 60;

/// Errors: settings, no surface near the point, out of time (hierarchical), what the scene and the
/// solver say.
Result<Probed> probe(const ProbeSettings& settings, Progress& progress);

/// The scene under its light from outside; `out` gets its unit of light and the warnings. Errors:
/// those of files and of light from outside.
Result<scene::Scene> read_probe_scene(const ProbeSettings& settings, Probed& out);
/// Errors: the light found at a place overflows.
Status check_held(const scene::Scene& scene, Vec3 place, const Probed& out);
/// ProbeMethod::hierarchical, for settings that probe() has checked. Errors: as there.
Result<Probed> probe_by_faces(const ProbeSettings& settings, Progress& progress);
/// ProbeMethod::paths, for settings that probe() has checked. Errors: as there.
Result<Probed> probe_by_paths(const ProbeSettings& settings, Progress& progress);
/// ProbeMethod::paths in a scene that is read already; settings.scene is only named in errors.
/// `out` comes with what reading has said.
Result<Probed> probe_by_paths(const ProbeSettings& settings, const scene::Scene& scene, Probed out,
                              Progress& progress);
/// ProbeMethod::bake, for settings that probe() has checked. Errors: as there.
Result<Probed> probe_in_bake(const ProbeSettings& settings, Progress& progress);

/// A point farther away from all surfaces than this part of the scene's diagonal is a mistake.
inline constexpr double kFarFromSurfaces = 0.1;
/// The error of such a point.
Error far_from_surfaces(const ProbeSettings& settings, double diagonal_m, double distance_m);
/// An instance's name, or its number where it has none.
std::string name_of(const scene::Scene& scene, uint32_t instance);

}  // namespace luxel::pipeline
