// All further bounces: sweeps over the stored hits, without a new ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/atlas/atlas.h"
#include "luxel/base/bytes_per_entry.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/light/light_estimate.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/elements.h"

namespace luxel::gather {

struct BounceParams {
  int bounces = -1;  ///< reflections to count; < 0: until the change is below `tolerance`
  /// Stop when the light of all bounces still to come is below this: its root mean square over the
  /// elements, relative to the mean irradiance.
  float tolerance = 1e-4f;
  /// With all bounces asked for: a guess of E per element to start from, as that of fewer samples;
  /// or nothing.
  std::span<const Rgb> start{};
  /// With a start: by how much a sweep over all rays would change it, per element, but for those of
  /// `unknown` (1 each); or nothing. It need not be exact: the light that is returned does not
  /// depend on it but for its tolerance.
  std::span<const Rgb> first_change{};
  std::span<const uint8_t> unknown{};
  /// Memory that may be taken besides the hits: sweeps over every 16th ray have a copy of those
  /// where it fits, which changes no bit.
  uint64_t spare_bytes = UINT64_MAX;
};

/// Bytes of that copy for elements with so many samples each, whose hits take `hit_bytes`.
double copy_bytes(double hit_bytes, int samples);

struct Bounced {
  std::vector<Rgb> irradiance;  ///< E per element [W/m^2], direct light included
  std::vector<float> variance;  ///< estimated variance of its luminance, direct light aside
  /// A second estimate of it, from the difference of two halves of the samples: ((A - B) / 2)^2.
  /// Each half is stratified, as the whole is, so that it is larger than the truth by a factor of
  /// 1.4 to 2 where `variance` may be 30 times too large; but each is a single square, as uncertain
  /// as that: for means over neighbours. docs/method/denoise.md.
  std::vector<float> split_variance;
  int sweeps = 0;
};
inline constexpr uint64_t kBouncedBytesPerElement =
    bytes_per_entry(&Bounced::irradiance, &Bounced::variance, &Bounced::split_variance);
/// With BounceParams::start, besides: the guess, and how far the light is from it.
inline constexpr uint64_t kGuessBytesPerElement = 2 * bytes_per_entry(&Bounced::irradiance);
/// With anything that scatters light through, besides: `behind`.
inline constexpr uint64_t kBehindBytesPerElement = sizeof(StoredHit);

/// Solves  E = E_0 + (1/N) sum over rays of B at the hit,  B = rho E + tau E behind,  E_0 = direct
/// light + soft sky seen, by Neumann iteration [Moreno05, eq. 3.4, 3.7]. Unlike the paper's running
/// average (eq. 3.15) this does not underestimate late bounces: every sweep uses all rays and the
/// whole map of the one before. Radiosity between texels is bilinear over those with an element.
/// With all bounces asked for, the first sweeps look at every 16th and then every 4th ray: their
/// solution is noisier, but a sweep averages that noise out, so that few sweeps over all rays are
/// left to do. The fixed point, and the test for having reached it, are those of all rays. `direct`
/// has one value per element, `behind` as well, or none: places_behind(). Errors: cancelled, the
/// file of hits cannot be read.
Result<Bounced> bounce(const atlas::TexelMap& map, const transport::Elements& elements,
                       const TracedHits& hits, std::span<const Rgb> direct,
                       std::span<const StoredHit> behind, const BounceParams& params,
                       Progress& progress);

/// E_0 of bounce(), and what each sweep over all rays makes of it: light after at most 0, 1, 2, ...
/// reflections, as long as `take` wants more and `bounces` (< 0: any number) allows. Errors: those
/// of bounce().
Status bounce_by_bounce(const atlas::TexelMap& map, const transport::Elements& elements,
                        const TracedHits& hits, std::span<const Rgb> direct,
                        std::span<const StoredHit> behind, int bounces, const light::OnBounce& take,
                        Progress& progress);

}  // namespace luxel::gather
