// A scene's transport in one codec.
#pragma once

#include "luxel/solve/matrix/matrix.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/trials.h"

namespace luxel::matrix {

/// Input of a codec.
struct CodecInput {
  const Prepared& prepared;
  const CoarseScene& coarse;
  const Trials& trials;  ///< of RelightParams::bounces
};

/// A codec, and what it errs by in each trial: errors_of().
struct MadeCodec {
  Codec codec;
  std::vector<double> errors;
};

/// The transport in the codec params.codec, as small as keeps to params.max_error (relative root
/// mean square over the trials), as far as can be. Errors: cancelled; a codec that cannot hold so
/// many patches.
Result<MadeCodec> make_codec(const CodecInput& t, const RelightParams& params, Progress& progress);

}  // namespace luxel::matrix
