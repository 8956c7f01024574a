// An .lxr file that is made of a scene while the scene is looked at.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "luxel/base/worker.h"
#include "luxel/view/edit/edits.h"
#include "luxel/view/relight/kept_lxr.h"
#include "luxel/view/relight/open_lxr.h"

namespace luxel::view {

/// Scene and settings of a file to be made.
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

/// Where it is cancelled, it leaves nothing half made. Errors: those of pipeline::relight() and of
/// files, cancelled.
Result<MadeLxr> make_lxr(const LxrToMake& to_make, Progress& progress);

using LxrMaker = Worker<LxrToMake, MadeLxr>;
std::unique_ptr<LxrMaker> begin_lxr_maker();

}  // namespace luxel::view
