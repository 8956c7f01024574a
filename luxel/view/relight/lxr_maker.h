// An .lxr file that is made of a scene while the scene is looked at.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/view/edit/edits.h"
#include "luxel/view/relight/kept_lxr.h"
#include "luxel/view/relight/open_lxr.h"

namespace luxel::view {

/// What it is made of.
struct LxrToMake {
  std::shared_ptr<const ReadScene> read;  ///< the scene as it was read, with its outside light
  SceneNow now;                           ///< and as it is
  pipeline::RelightSettings settings;     ///< `output` is the file; its folder need not be there
};

/// A file that has been made, or was there, and is open. Its lamps are those of LxrToMake::now that
/// are not deleted; those that are off are off.
struct MadeLxr {
  OpenedLxr opened;
  std::vector<std::string> warnings;
  bool was_there = false;
};

/// Guards a thread. Its functions are called by one thread and do not wait for it, but for the
/// destructor, which ends it within some tenths of a second and leaves nothing half made, and
/// wait().
class LxrMaker {
 public:
  static std::unique_ptr<LxrMaker> begin(LxrToMake to_make);
  virtual ~LxrMaker() = default;

  virtual Progress::Snapshot snapshot() const = 0;
  /// Once, when it has ended. Errors: those of pipeline::relight() and of files.
  virtual std::optional<Result<MadeLxr>> take() = 0;
  virtual void wait() = 0;
};

}  // namespace luxel::view
