// DIR/cache: what a bake with --keep leaves, and what the next one finds. docs/method/rebake.md
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "luxel/base/part_store.h"
#include "luxel/base/progress.h"
#include "luxel/pipeline/reuse/kept_bake.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// With settings.keep a bake either builds on what is kept, and leaves that as it is, or keeps
/// itself. A cache that cannot be used is no error: the bake starts from scratch and says why.
class BakeCache {
 public:
  /// `settings` outlives this; `identity` are those of them that must be equal in a bake that
  /// builds on this one (settings_of_kept_bake).
  BakeCache(const BakeSettings& settings, const nlohmann::json& identity);
  BakeCache(const BakeCache&) = delete;
  BakeCache& operator=(const BakeCache&) = delete;
  ~BakeCache();  ///< what was begun and not finished goes

  /// The scene is known, with its outside light. Looks for what is kept of it; where there is
  /// nothing to build on, a cache is begun.
  void open(const scene::Scene& scene, Progress& progress);

  /// The kept bake to build on; null: there is none, or it is not asked for.
  KeptBake* found() { return found_ ? &*found_ : nullptr; }
  /// With found(): what is different in the scene.
  const scene::SceneChange& change() const { return change_; }
  /// With found(): its rays; null where they are damaged or gone, which is noted.
  const RecordFile* found_rays(Progress& progress);

  /// Where this bake keeps itself; null: it does not.
  PartStore* rays() { return rays_ ? &*rays_ : nullptr; }
  /// With rays(): the rest of it, but for scene, seconds and layout.
  void keep(KeptBake kept) { kept_ = std::move(kept); }
  void keep(KeptLayout layout) { layout_ = std::move(layout); }
  /// The bake's light is there: what it took is measured up to here.
  void solved();
  /// The bake is done. If it keeps itself it can be found from now on.
  void finish(Progress& progress);

  /// For bake.json; null without settings.keep. `light` is the bake's.
  nlohmann::json about(const TexelLight& light) const;
  /// Why nothing is kept though it was asked for; empty: it is, or was not asked for.
  std::string failure() const;
  /// The bake must do with the room that its unfinished files take. Whether there were any.
  bool make_room(Progress& progress);

 private:
  bool find(const scene::Scene& scene);
  void begin(Progress& progress);
  void give_up(std::string reason, Progress& progress);
  void remove_unfinished();

  const BakeSettings& settings_;
  std::unique_ptr<nlohmann::json> identity_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::filesystem::path folder_;
  scene::SceneState state_;
  scene::SceneChange change_;
  std::string changed_, note_, failure_;
  double seconds_ = 0, seconds_before_ = 0;
  std::optional<KeptBake> found_;
  std::optional<RecordFile> found_rays_;
  std::optional<PartStore> rays_;
  std::optional<KeptBake> kept_;
  KeptLayout layout_;
  bool built_on_ = false;
};

}  // namespace luxel::pipeline
