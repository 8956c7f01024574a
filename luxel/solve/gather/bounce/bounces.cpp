#include "luxel/solve/gather/bounce/bounces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "luxel/base/check.h"
#include "luxel/solve/gather/bounce/convergence.h"
#include "luxel/solve/gather/bounce/sweep.h"

namespace luxel::gather {
namespace {

/// With rho = 0.99, the most there is, light to come is rho^n / (1 - rho) of the first change after
/// n sweeps: 1e-4 after 1,380. Three times as many mean that something is wrong.
constexpr int kMaxSweeps = 4000;

/// A guess is brought closer by sparse sweeps if its light to come is more than so many times the
/// tolerance: two sweeps over all rays do as much where the mean reflectance is a half.
constexpr double kFarFrom = 4;
/// Sparse sweeps end when they change less than this part of their first change: five sweeps at a
/// reflectance of a half.
constexpr double kSmallPart = 0.03;
/// They also end when what is left is below this part of the tolerance: the other three parts are
/// for the sparse sweeps' own noise.
constexpr double kSmallRest = 0.25;
/// So many of them over every 16th ray take about as long as half a sweep over all. What is left is
/// taken for a geometric series.
constexpr int kMaxSparse = 8;
/// Progress counts all sweeps as so many units.
constexpr uint64_t kUnits = 1000;
/// Sparse sweeps may bring a guess so much less closer than the last time (1.46 was seen).
constexpr double kUnsure = 1.5;

/// The solution on its way.
struct Bouncing {
  const atlas::TexelMap& map;
  const transport::Elements& elements;
  const TracedHits& hits;
  std::span<const Rgb> direct;
  std::span<const StoredHit> behind;
  Progress& progress;
  uint64_t spare_bytes = 0;
  ReflectanceRange reflectance;
  RadiosityMap radiosity{};
  std::optional<SubsampledHits> subsampled{};
  Bounced out{};
  double done = 0;    ///< sweeps, in those over all rays
  uint64_t told = 0;  ///< of kUnits

  void tell(double share);
  Status make_subsampled(size_t stride);
  const SubsampledHits* subsampled_at(size_t stride) const {
    return subsampled && subsampled->stride == stride ? &*subsampled : nullptr;
  }
  Result<double> sweep(size_t stride);
  double relative(double change2) const;
  Result<double> first_sweep(const BounceParams& params);
  Result<double> look_ahead(std::vector<Rgb> change, size_t stride, double tolerance);
  Status settle(size_t stride, float tolerance);
  Status settle_guess(size_t sparse, const BounceParams& params);
  Result<Bounced> finished();
};

/// Tells the watcher what is done of all sweeps.
void Bouncing::tell(double share) {
  const auto units = uint64_t(share * double(kUnits));
  if (units > told) progress.advance(units - std::exchange(told, units));
}

/// A copy of a quarter would take too much beside the hits.
Status Bouncing::make_subsampled(size_t stride) {
  if (stride < kSparsest || subsampled) return {};
  LUXEL_TRY(subsampled, subsample(hits, stride, spare_bytes, progress));
  return {};
}

/// Returns the root mean square change, relative to the mean irradiance.
Result<double> Bouncing::sweep(size_t stride) {
  fill_radiosity(radiosity, map, elements, hits, behind, out.irradiance);
  Sweep sweep{.direct = direct,
              .irradiance = out.irradiance,
              .variance = out.variance,
              .split_variance = out.split_variance,
              .stride = stride,
              .subsampled = subsampled_at(stride)};
  LUXEL_TRY_STATUS(run_sweep(radiosity, hits, sweep, progress));
  ++out.sweeps;
  done += cost_of_sweep(stride);
  return relative(std::accumulate(sweep.change2.begin(), sweep.change2.end(), 0.0));
}

/// A squared change over all elements as a root mean square, relative to the mean irradiance.
double Bouncing::relative(double change2) const {
  const double mean = mean_luminance(out.irradiance);
  return mean > 0 ? std::sqrt(change2 / (3 * double(hits.size()))) / mean : 0.0;
}

/// Does sweep(1) to irradiance, by params.first_change where that is known; there variances stay.
Result<double> Bouncing::first_sweep(const BounceParams& params) {
  fill_radiosity(radiosity, map, elements, hits, behind, out.irradiance);
  Sweep sweep{.direct = direct,
              .irradiance = out.irradiance,
              .variance = out.variance,
              .split_variance = out.split_variance,
              .only = params.unknown};
  LUXEL_TRY_STATUS(run_sweep(radiosity, hits, sweep, progress));
  double change2 = std::accumulate(sweep.change2.begin(), sweep.change2.end(), 0.0);
  for (size_t i = 0; i < hits.size(); ++i) {
    if (params.unknown[i]) continue;
    const Rgb change = params.first_change[i];
    out.irradiance[i] = max(out.irradiance[i] + change, Rgb{});
    change2 += double(dot(change, change));
  }
  return relative(change2);
}

/// Adds what a change makes of itself in later bounces, looking at some rays only: as exact,
/// relative to the change, as these are. Returns the ratio of its last two steps.
Result<double> Bouncing::look_ahead(std::vector<Rgb> change, size_t stride, double tolerance) {
  LUXEL_TRY_STATUS(make_subsampled(stride));
  const size_t n = change.size();
  double first = 0, before = 0, ratio = 0;
  for (int k = 0; k < kMaxSparse; ++k) {
    fill_radiosity(radiosity, map, elements, hits, behind, change);
    Sweep sweep{.irradiance = change, .stride = stride, .subsampled = subsampled_at(stride)};
    LUXEL_TRY_STATUS(run_sweep(radiosity, hits, sweep, progress));
    double sum2 = 0;
    for (size_t i = 0; i < n; ++i)
      out.irradiance[i] += change[i], sum2 += double(dot(change[i], change[i]));
    if (k == 0) first = sum2;
    ratio = before > 0 ? std::sqrt(sum2 / before) : 0, before = sum2;
    if (sum2 <= kSmallPart * kSmallPart * first) break;
    if (light_to_come(relative(sum2), ratio, reflectance) <= kSmallRest * tolerance) break;
  }
  // By now each step is nearly the same as the one before, but smaller.
  const double q = std::min(ratio, reflectance.max);
  const float left = float(q / (1 - q));
  for (size_t i = 0; i < n; ++i) out.irradiance[i] += change[i] * left;
  for (Rgb& e : out.irradiance) e = max(e, Rgb{});
  return ratio;
}

/// Sweeps until the light to come is below the tolerance.
Status Bouncing::settle(size_t stride, float tolerance) {
  LUXEL_TRY_STATUS(make_subsampled(stride));
  double before = 0, ratio = 0;
  for (int k = 0; k < kMaxSweeps; ++k) {
    LUXEL_TRY(const double change, sweep(stride));
    if (before > 0) ratio = change / before;
    const double goal = double(tolerance) * double(stride),
                 to_come = light_to_come(change, ratio, reflectance);
    if (to_come <= goal) break;
    if (ratio > 0 && ratio < 1)
      tell(share_of_sweeps(done, std::log(to_come / goal) / -std::log(ratio), stride, ratio));
    before = change;
  }
  return {};
}

/// Sweeps as settle() does, but from a guess: what a sweep over all rays changes is carried on by
/// sparse ones. How much
/// closer that has come is seen by the next, and is what can be expected of another time.
Status Bouncing::settle_guess(size_t sparse, const BounceParams& params) {
  const float tolerance = params.tolerance;
  double before = 0, ratio = 0, to_come_before = 0;
  for (int k = 0; k < kMaxSweeps; ++k) {
    std::vector<Rgb> changed = out.irradiance;
    const bool is_known = k == 0 && !params.first_change.empty();
    LUXEL_TRY(const double change, is_known ? first_sweep(params) : sweep(1));
    if (before > 0) ratio = change / before;
    const double to_come = light_to_come(change, ratio, reflectance);
    if (to_come <= double(tolerance) && !is_known) break;
    before = change;
    const bool has_come_closer = to_come_before > to_come;
    if (!has_come_closer && to_come < kFarFrom * double(tolerance)) continue;
    for (size_t i = 0; i < changed.size(); ++i) changed[i] = out.irradiance[i] - changed[i];
    LUXEL_TRY(ratio, look_ahead(std::move(changed), sparse, double(tolerance)));
    if (has_come_closer && kUnsure * to_come * to_come / to_come_before <= double(tolerance)) break;
    to_come_before = to_come;
    before = 0;  // the next change does not follow this one
  }
  return {};
}

/// Errors: another member of the team gives up, cancelled.
Result<Bounced> Bouncing::finished() {
  LUXEL_TRY_STATUS(give_variances(hits, out.variance, out.split_variance, progress));
  return std::move(out);
}

}  // namespace

double copy_bytes(double hit_bytes, int samples) {
  constexpr double kPerHit = double(sizeof(StoredHit) + sizeof(float)) / sizeof(StoredHit);
  return !has_sweeps_of(kSparsest, size_t(samples)) ? 0 : kPerHit * hit_bytes / kSparsest;
}

Result<Bounced> bounce(const atlas::TexelMap& map, const transport::Elements& elements,
                       const TracedHits& hits, std::span<const Rgb> direct,
                       std::span<const StoredHit> behind, const BounceParams& params,
                       Progress& progress) {
  const size_t n = elements.size();
  LUXEL_CHECK(direct.size() == n && map.texels.size() == n && hits.sky.size() == n);
  LUXEL_CHECK(behind.size() == elements.transmittance.size());
  Bouncing bouncing{map,
                    elements,
                    hits,
                    direct,
                    behind,
                    progress,
                    params.spare_bytes,
                    reflectance_range(elements)};
  const bool guessed = params.bounces < 0 && !params.start.empty();
  LUXEL_CHECK(!guessed || params.start.size() == n);
  LUXEL_CHECK(params.first_change.empty() ||
              (guessed && params.first_change.size() == n && params.unknown.size() == n));
  bouncing.out.irradiance.assign(guessed ? params.start.begin() : direct.begin(),
                                 guessed ? params.start.end() : direct.end());
  if (!guessed)
    for (size_t i = 0; i < n; ++i) bouncing.out.irradiance[i] = source_of(hits, direct, i);
  bouncing.out.variance.assign(n, 0.0f), bouncing.out.split_variance.assign(n, 0.0f);
  bouncing.radiosity = empty_radiosity_map(map.resolution);
  progress.begin("bounces", kUnits);
  for (int k = 0; k < params.bounces; ++k) {
    LUXEL_TRY_STATUS(bouncing.sweep(1).map([](double) {}));
    bouncing.tell(double(k + 1) / params.bounces);
  }
  if (params.bounces >= 0) return bouncing.finished();
  // A device has no sparse sweeps: those over all of its rays take about as long as the map needs
  // to get there.
  const bool may_be_sparse = !hits.samples.empty() && !hits.device;
  const size_t fewest = may_be_sparse ? *std::ranges::min_element(hits.samples) : 0;
  const size_t sparse = sparsest_stride(fewest);
  if (guessed && sparse > 1) {
    LUXEL_TRY_STATUS(bouncing.settle_guess(sparse, params));
    return bouncing.finished();
  }
  for (const size_t stride : kStrides) {
    if (stride > 1 && (guessed || !has_sweeps_of(stride, fewest))) continue;
    LUXEL_TRY_STATUS(bouncing.settle(stride, params.tolerance));
    bouncing.subsampled.reset();
  }
  return bouncing.finished();
}

Status bounce_by_bounce(const atlas::TexelMap& map, const transport::Elements& elements,
                        const TracedHits& hits, std::span<const Rgb> direct,
                        std::span<const StoredHit> behind, int bounces, const light::OnBounce& take,
                        Progress& progress) {
  const size_t n = elements.size();
  LUXEL_CHECK(direct.size() == n && map.texels.size() == n && hits.sky.size() == n);
  Bouncing bouncing{map, elements, hits, direct, behind, progress, 0, reflectance_range(elements)};
  for (size_t i = 0; i < n; ++i) bouncing.out.irradiance.push_back(source_of(hits, direct, i));
  bouncing.out.variance.assign(n, 0.0f), bouncing.out.split_variance.assign(n, 0.0f);
  bouncing.radiosity = empty_radiosity_map(map.resolution);
  for (int k = 0; take(bouncing.out.irradiance) && k != bounces; ++k)
    LUXEL_TRY_STATUS(bouncing.sweep(1).map([](double) {}));
  return {};
}

}  // namespace luxel::gather
