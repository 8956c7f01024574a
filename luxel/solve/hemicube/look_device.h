// A graphics device that looks through hemicubes; luxel/solve/device/ has one. Hemicubes themselves
// know no graphics.
#pragma once

#include "luxel/solve/hemicube/look.h"

namespace luxel::hemicube {

/// Looks through hemicubes in place of the processor.
class LookDevice {
 public:
  virtual ~LookDevice() = default;

  /// Takes a scene, in place of any before; what follows is about this one. It is kept by reference
  /// until forget(). Errors: no memory, the device is lost.
  virtual Status begin(const scene::Scene& scene) = 0;

  /// look(), in the scene of begin(). The device's seconds count as visibility. Errors: those of
  /// look(), something that it does not know is seen (ErrorCode::unsupported), no memory, the
  /// device is lost.
  virtual Result<LookSeconds> look(const Senders& senders, std::span<const Viewpoint> from,
                                   const LookParams& params, const OnView& done,
                                   Progress& progress) = 0;

  /// Gives the memory of the scene back.
  virtual void forget() = 0;
};

}  // namespace luxel::hemicube
