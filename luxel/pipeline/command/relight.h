// A scene in, the file that relights it out: `luxel relight`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/pipeline/solver/matrix.h"
#include "luxel/solve/matrix/relight.h"

namespace luxel::pipeline {

/// More rays than a bake has by default: the codec tells noise from light when there is little.
inline matrix::MatrixParams relight_matrix() {
  matrix::MatrixParams params;
  params.factors.rays_per_patch = 8192;
  return params;
}

/// Settings of `luxel relight`.
struct RelightSettings {
  std::filesystem::path scene;
  std::filesystem::path output;   ///< .lxr
  std::string target = "texels";  ///< or "vertices", "none"
  int resolution = 256;           ///< texels: side of the map
  float texels_per_metre = 0;     ///< texels: > 0: chooses the resolution
  atlas::UvMode uv = atlas::UvMode::automatic;
  matrix::MatrixParams matrix = relight_matrix();  ///< what --patches and --rays say
  std::string codec = "hierarchical";              ///< one of codec_names()
  double max_error = 0.01;                         ///< what the codec may lose
  int bounces = -1;                                ///< < 0: all
  uint64_t max_memory_bytes = 0;                   ///< 0: four fifths of what is free
  uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores
  import::ImportParams reading;
  OutsideLight outside;
};

/// "hierarchical, ...".
std::string codec_names();

/// A scene prepared for light that moves, before anything is written.
struct Relightable {
  matrix::RelightData data;
  std::vector<std::string> warnings;
};

/// Prepares a scene that is there, with its outside light; one without any stays dark. Of the
/// settings, `scene` is a name for messages, and neither `reading` nor `outside` is looked at; see
/// check(). Members of a team share rays of form factors out; all but the first end with
/// ErrorCode::parts_missing then. Errors: whatever the stages say.
Result<Relightable> make_relightable(scene::Scene scene, const RelightSettings& settings,
                                     Progress& progress, Team* team = nullptr);

/// Writes settings.output, and ends the progress. Returns what `--json` prints: settings, counts,
/// bytes, seconds. Errors: those of files; cancelled.
Result<nlohmann::json> write_relightable(const RelightSettings& settings, const Relightable& made,
                                         Progress& progress);

/// Errors (bad_setting): settings out of range. settings.output is not looked at.
Status check_making(const RelightSettings& settings);
/// check_making(). Errors of files: settings.output cannot be written.
Status check(const RelightSettings& settings);

/// Reads settings.scene, prepares it and writes settings.output. Returns what write_relightable()
/// does, and at members of a team that are not its first {}. Errors: whatever the stages say;
/// settings out of range.
Result<nlohmann::json> relight(const RelightSettings& settings, Progress& progress,
                               Team* team = nullptr);

}  // namespace luxel::pipeline
