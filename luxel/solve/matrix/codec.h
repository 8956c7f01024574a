// The question to all codecs: irradiance from what patches send, after all bounces.
#pragma once

#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

/// Room for one answer of a codec; what it does not use is empty.
struct CodecScratch {
  HierarchicalScratch hierarchical;
  DenseScratch dense;
  Bc1Scratch bc1;
  LowRankScratch low_rank;
  BounceScratch bounces;
};
/// Allocates what the codec uses, for one answer at a time.
CodecScratch make_scratch(const Codec& codec, size_t patches);

/// E of all patches from each other. Allocates nothing.
void irradiance_of(const Codec& codec, const Sent& sent, std::span<Rgb> irradiance,
                   CodecScratch& scratch);

/// Memory of the data that the codec keeps [bytes].
uint64_t bytes_of(const Codec& codec);

}  // namespace luxel::matrix
