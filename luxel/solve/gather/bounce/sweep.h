// One pass over the stored hits: each element gathers what the map sends to its rays.
#pragma once

#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/bounce/subsampled_hits.h"
#include "luxel/solve/gather/rays/traced_hits.h"

namespace luxel::gather {

struct Gathered {
  Float4 sum{};
  float sum_luminance2 = 0;
  float first_less_second = 0;  ///< luminance of the first half of the samples minus the other's
};

/// Adds an element's hits of a round. Only in its last round do they know which half of all they
/// belong to; before, all is of the first.
void gather_round(const RadiosityMap& m, std::span<const StoredHit> hits, bool last, Gathered& g);

/// E_0 of an element: what arrives without any reflection. A ray that escapes sees the sky.
Rgb source_of(const TracedHits& hits, std::span<const Rgb> direct, size_t element);

/// One sweep's input and output. `change2` holds the squared change per tile: summed in a fixed
/// order.
struct Sweep {
  std::span<const Rgb> direct{};  ///< empty: E_0 is none
  std::span<Rgb> irradiance{};    ///< E of the sweep before, then of this one
  std::span<float> variance{};    ///< of the gathered part and the sky
  std::span<float> split_variance{};
  std::span<const uint8_t> only{};  ///< with stride 1, per element, 1: it is looked at; empty: all
  size_t stride = 1;  ///< only every stride-th ray is looked at; variances only with 1
  const SubsampledHits* subsampled = nullptr;  ///< of that stride; null: there are none
  std::vector<double> change2{};
};

/// Hits on a device are swept there, with stride 1 alone; those of a team by their owners, and all
/// members get irradiance and change2 of all elements, but variances of their own alone. Errors:
/// the file of hits cannot be read, the device is lost, another member gives up, cancelled.
Status run_sweep(const RadiosityMap& m, const TracedHits& hits, Sweep& sweep, Progress& progress);
/// Gives all members of a team the variances that run_sweep() has left with each. Errors: another
/// member gives up, cancelled.
Status give_variances(const TracedHits& hits, std::span<float> variance,
                      std::span<float> split_variance, Progress& progress);

}  // namespace luxel::gather
