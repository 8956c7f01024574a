#include "luxel/solve/gather/budget/rms_round.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/solve/gather/budget/adaptive.h"

namespace luxel::gather {
namespace {

/// What is left of a variance when samples are doubled, or made four times as many: the square of
/// a standard error that falls like n^-kDecay.
const float kLeftOfTwice = std::exp2(-2 * kDecay);
const float kLeftOfFourTimes = kLeftOfTwice * kLeftOfTwice;

/// Steps are sorted by the fall of variance per cost, in powers of 2^(1/kStepsPerOctave).
constexpr int kStepsPerOctave = 8, kOctavesOfGain = 256;
int bin_of(double gain, double cost) {
  const double octave = std::log2(gain / cost) + kOctavesOfGain / 2;
  return std::clamp(int(octave * kStepsPerOctave), 0, kOctavesOfGain * kStepsPerOctave - 1);
}

/// One thing to do for an element.
struct RmsStep {
  double gain = 0, cost = 0;
  bool helps() const { return gain > 0 && cost > 0; }
  int bin() const { return bin_of(gain, cost); }
};
/// Twice the samples, and twice those once more; direct light one level finer.
struct ElementSteps {
  RmsStep twice, four_times, finer;
};

ElementSteps steps_of(const NoiseLeft& noise, const RayCosts& costs, int max_samples, size_t i) {
  ElementSteps out;
  const double v = double(noise.gathered[i]);
  const int n = int(noise.samples[i]);
  const double doubling = double(n) * costs.sample;
  if (2 * n <= max_samples) out.twice = {v * (1 - double(kLeftOfTwice)), doubling};
  if (4 * n <= max_samples)
    out.four_times = {v * double(kLeftOfTwice - kLeftOfFourTimes), 2 * doubling};
  if (!can_be_finer(noise.levels, i)) return out;
  const double first = noise.levels.averaged[i] ? costs.at_points : costs.at_sample;
  // All its rays are traced anew.
  out.finer = {double(noise.direct[i]) * (1 - double(kLeftOfFourTimes)),
               std::ldexp(first, 2 * (int(noise.levels.level[i]) + 1))};
  return out;
}

/// The lowest bin of steps that are taken, all above it being taken, too.
int lowest_bin(const NoiseLeft& noise, double allowed, double affordable, const RayCosts& costs,
               int max_samples) {
  std::vector<RmsStep> bins(size_t(kOctavesOfGain * kStepsPerOctave));
  double all = 0;
  for (size_t i = 0; i < noise.samples.size(); ++i) {
    all += double(noise.gathered[i]) + double(noise.direct[i]);
    const ElementSteps steps = steps_of(noise, costs, max_samples, i);
    for (const RmsStep& step : {steps.twice, steps.four_times, steps.finer}) {
      if (!step.helps()) continue;
      RmsStep& bin = bins[size_t(step.bin())];
      bin.gain += step.gain, bin.cost += step.cost;
    }
  }
  int bin = int(bins.size());
  for (double cost = 0; bin > 0 && all > allowed; --bin) {
    const RmsStep& next = bins[size_t(bin - 1)];
    cost += next.cost;
    if (cost > affordable) break;
    all -= next.gain;
  }
  return bin;
}

}  // namespace

RayCosts ray_costs(double rays_per_sample, double shadow_rays_at_sample,
                   double shadow_rays_at_points) {
  return {rays_per_sample, kShadowRay * shadow_rays_at_sample, kShadowRay * shadow_rays_at_points};
}

RoundPlan plan_rms_round(const NoiseLeft& noise, double allowed, double affordable,
                         const RayCosts& costs, int max_samples) {
  const size_t n = noise.samples.size();
  LUXEL_CHECK(noise.gathered.size() == n && noise.direct.size() == n);
  const int lowest = lowest_bin(noise, allowed, affordable, costs, max_samples);
  RoundPlan out{{noise.samples.begin(), noise.samples.end()}, std::vector<uint8_t>(n)};
  const auto is_taken = [&](const RmsStep& step) { return step.helps() && step.bin() >= lowest; };
  for (size_t i = 0; i < n; ++i) {
    const ElementSteps steps = steps_of(noise, costs, max_samples, i);
    if (is_taken(steps.twice)) out.samples[i] = uint16_t(2 * int(noise.samples[i]));
    if (is_taken(steps.four_times)) out.samples[i] = uint16_t(4 * int(noise.samples[i]));
    out.finer[i] = is_taken(steps.finer);
  }
  return out;
}

std::vector<float> variances_of(std::span<const float> relative_errors,
                                std::span<const Rgb> irradiance) {
  LUXEL_CHECK(relative_errors.size() == irradiance.size());
  const float darkest = darkest_light(irradiance);
  std::vector<float> out(irradiance.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const float error = relative_errors[i] * std::max(luminance(irradiance[i]), darkest);
    out[i] = error * error;
  }
  return out;
}

}  // namespace luxel::gather
