// Compares the light of the lamps with the path tracer's, in the background.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "luxel/base/worker.h"
#include "luxel/pipeline/command/relight_error.h"
#include "luxel/view/relight/open_lxr.h"

namespace luxel::view {

/// Texels that are asked, and paths from each, twice: a few seconds on two cores.
struct LampCheckParams {
  size_t places = 512;
  int paths = 2048;
  uint64_t seed = 1;
};

/// Texels, and the light that they have.
struct CheckedTexels {
  std::vector<Vec3> position, normal, geometric_normal;
  std::vector<Rgb> indirect;
};

/// Light that is to be compared.
struct LampsToCheck {
  std::shared_ptr<const ReadScene> read;
  CheckedTexels texels;
  int bounces = -1;
  Lamps baked, now;
  LampCheckParams params;
};
/// The light of these lamps, which opened.light has afterwards.
LampsToCheck lamps_to_check(OpenedLxr& opened, const Lamps& now, const LampCheckParams& params);
/// Errors: cancelled.
Result<pipeline::IndirectError> check_lamps(const LampsToCheck& asked, Progress& progress);

using LampCheck = Worker<LampsToCheck, pipeline::IndirectError>;
std::unique_ptr<LampCheck> begin_lamp_check();

/// One sentence: the texels compared, and how far their light is off.
std::string sentence_of(const pipeline::IndirectError& error, const LampCheckParams& params);

}  // namespace luxel::view
