// Interface to a graphics device that computes direct light; luxel/light/device/ has it. The rest
// of the room knows no graphics.
#pragma once

#include <cstdint>
#include <span>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel::light {

struct LightAt;
struct Receiver;

/// The light that receivers get, and how well it is known.
struct LightAsked {
  int samples = 64;             ///< DirectParams::samples
  bool punctual_alone = false;  ///< that of punctual lights, with so many rays for each sun's disc
};

/// Lights any places of one scene. One thread at a time uses it.
class LightDevice {
 public:
  virtual ~LightDevice() = default;

  /// direct_light_at(), or punctual_light_at(), of each receiver: the same shadow rays up to
  /// rounding. Where both triangles and punctual lights are drawn, the variance of either is
  /// estimated for itself. `progress` is asked whether to stop. Returns the number of shadow rays.
  /// Errors: cancelled, no memory, the device is lost.
  virtual Result<uint64_t> light_at(std::span<const Receiver> receivers, const LightAsked& asked,
                                    std::span<LightAt> out, Progress& progress) = 0;
};

}  // namespace luxel::light
