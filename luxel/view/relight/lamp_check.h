// How far the light of the lamps is from the path tracer's, asked in the background.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "luxel/pipeline/command/relight_error.h"
#include "luxel/view/relight/open_lxr.h"

namespace luxel::view {

/// Texels that are asked, and paths from each, twice: a few seconds on two cores.
struct LampCheckParams {
  size_t places = 512;
  int paths = 2048;
  uint64_t seed = 1;
};

/// Guards a thread. Its functions are called by one thread and do not wait for it, but for the
/// destructor, which ends it within about 0.2 s, and wait().
class LampCheck {
 public:
  /// Asks about the light of these lamps, which opened.light has afterwards.
  static std::unique_ptr<LampCheck> begin(OpenedLxr& opened, const Lamps& now,
                                          const LampCheckParams& params);
  virtual ~LampCheck() = default;

  /// The share that is done.
  virtual float share() const = 0;
  /// None: it is still asked. Errors: there is no memory.
  virtual std::optional<Result<pipeline::IndirectError>> result() const = 0;
  virtual void wait() = 0;
};

/// What is to be told of it: what was compared, and how far it is off.
std::string sentence_of(const pipeline::IndirectError& error, const LampCheckParams& params);

}  // namespace luxel::view
