// Where direct light of patches is taken: a few points of each.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/matrix/patches.h"

namespace luxel::matrix {

/// The probes of every patch as elements, patch after patch.
struct Probes {
  transport::Elements elements;
  std::vector<size_t> first;  ///< per patch, one extra entry
};
Probes probes_of(const Patches& patches);

/// The mean of each patch's probes.
std::vector<Rgb> mean_at_patches(const Probes& probes, std::span<const Rgb> at_probes);

}  // namespace luxel::matrix
