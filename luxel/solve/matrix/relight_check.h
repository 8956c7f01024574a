// Checks that data can be played: the content of a file may be anything.
#pragma once

#include "luxel/base/result.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

/// Everything that a player relies on: lengths agree, indices stay inside, lists of ranges ascend,
/// clusters make a tree, numbers are finite and in their ranges. Errors: the first that is wrong.
Status check(const RelightData& data);

/// Checks of its parts, one function each. `patches` is their number. Errors as above.
Status check(const HierarchicalCodec& codec, size_t patches);
Status check(const DenseCodec& codec, size_t patches);
Status check(const Bc1Codec& codec, size_t patches);
Status check(const LowRankCodec& codec, size_t patches);
Status check(const Hierarchical& matrix, size_t patches);
Status check(const Dense& matrix, size_t patches);
Status check(const LowRank& matrix, size_t patches);
Status check(const CoarseScene& coarse, size_t patches);
Status check(const Transfer& map, size_t places, size_t patches);
Status check(const Target& target, size_t patches);
Status check(const Occluders& occluders);

}  // namespace luxel::matrix
