// Remains of a bake that was stopped or killed, for the next one to go on with.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "luxel/base/part_store.h"
#include "luxel/base/progress.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/scene/scene.h"

namespace luxel::pipeline {

/// Everything but its scene that the light of a bake depends on: luxel's version, and those of the
/// `settings` that change light (solver/bake_options.h says which).
nlohmann::json bake_identity(const nlohmann::json& settings);
/// That, and the scene's digests.
nlohmann::json checkpoint_header(const nlohmann::json& settings, const scene::Scene& scene);
/// Differences between the two, in words; empty: none.
std::string difference(const nlohmann::json& there, const nlohmann::json& here);

/// The checkpoint of one bake: docs/method/checkpoints.md. Solvers that keep no parts have none.
class Checkpoint {
 public:
  /// The bake begins now. `settings` outlives this; `identity` is what must be equal in a bake that
  /// goes on with it (settings_of_checkpoint), `all_settings` what the file says to who ends the
  /// bake (to_json). Each member of a team has one, of the same bake; null: it is one process's.
  Checkpoint(const BakeSettings& settings, const nlohmann::json& identity,
             const nlohmann::json& all_settings, const Team* team = nullptr);
  ~Checkpoint();

  /// The scene is known, with its outside light. With settings.resume goes on with the file that is
  /// there; says in a note when there is none, or one that is not gone on with. A part of a bake
  /// always goes on with its file, and everything is kept. What is in other_parts() is found, too;
  /// of these, checkpoints of other bakes are left alone, which a note says. Errors: a file is of
  /// another bake, or damaged.
  Status open(const scene::Scene& scene, Progress& progress);
  /// Null before open(), and where nothing is kept.
  PartStore* parts() { return parts_ ? &*parts_ : nullptr; }
  /// For bake.json; null where nothing is kept.
  nlohmann::json about() const;
  /// True: a file is there and takes room on the disk.
  bool has_file() const;
  /// The bake is done, or must do without: nothing of it stays, by whichever process.
  void remove();

 private:
  Result<std::optional<RecordFile>> own_file(const std::string& header, Progress& progress);
  Result<std::vector<RecordFile>> other_files(const std::string& header, Progress& progress) const;

  const BakeSettings& settings_;
  std::filesystem::path file_;
  std::unique_ptr<nlohmann::json> identity_, all_settings_;
  std::chrono::steady_clock::time_point start_;
  bool resumed_ = false;
  std::string note_, header_;
  std::optional<PartStore> parts_;
};

}  // namespace luxel::pipeline
