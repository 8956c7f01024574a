#include "luxel/solve/gather/budget/rms_round.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "luxel/base/check.h"
#include "luxel/solve/gather/budget/adaptive.h"

namespace luxel::gather {
namespace {

/// Variances are squares of standard errors, which fall like n^-kDecay.
constexpr double kExponent = -2 * double(kDecay);
const float kLeftOfFourTimes = std::exp2(-4 * kDecay);

/// Steps are sorted by the fall of variance per cost, in powers of 2^(1/kStepsPerOctave).
constexpr int kStepsPerOctave = 8, kOctavesOfGain = 256;
int bin_of(double gain, double cost) {
  const double octave = std::log2(gain / cost) + kOctavesOfGain / 2;
  return std::clamp(int(octave * kStepsPerOctave), 0, kOctavesOfGain * kStepsPerOctave - 1);
}

/// One thing to do for an element, in place of the step before.
struct RmsStep {
  double gain = 0, cost = 0;
  uint16_t samples = 0;  ///< that it has then
  uint8_t guided = 0;    ///< TracedHits
  bool helps() const { return gain > 0 && cost > 0; }
  int bin() const { return bin_of(gain, cost); }
};
/// More rays, from step to step for less per ray; direct light one level finer.
struct ElementSteps {
  std::array<RmsStep, kGuideLevels + 2> more;
  size_t count = 0;
  RmsStep finer;

  std::span<const RmsStep> of_rays() const { return {more.data(), count}; }
};

/// One choice for an element: so many samples, with the guide at a level.
struct Choice {
  double left = 0, cost = 0;  ///< of the variance, and rays that are traced for it
  uint16_t samples = 0;
  uint8_t guided = 0;
};
struct Choices {
  std::array<Choice, kGuideLevels + 2> all;
  size_t count = 0;

  void add(const Choice& choice) { all[count++] = choice; }
};

/// The guide that an element's rays may follow from now on; null: none.
const GuidedGroup* group_to_follow(const NoiseLeft& noise, size_t i) {
  if (!noise.guided || noise.guided->guide.of_element.empty() || is_guided(*noise.guided, i))
    return nullptr;
  const Guide& guide = noise.guided->guide;
  return guide.of_element[i] == kNoGuide ? nullptr : &guide.groups[guide.of_element[i]];
}

/// The fewest samples of rays that follow a guide: fewer would leave cells without any ray, and how
/// much those differ from each other is no part of what the guide knows.
constexpr int kFewestGuided = int(kCells);
/// So few rays do not know their own variance well enough for more than so many times as many.
constexpr double kMostAnew = 16;

Choices choices_of(const NoiseLeft& noise, double ray, int max_samples, size_t i) {
  Choices out;
  const double v = double(noise.gathered[i]);
  const int n = int(noise.samples[i]);
  const double rays = noise.guided ? double(n) * double(rays_per_sample(*noise.guided, i)) : n;
  for (const int times : {2, 4})
    if (times * rays <= max_samples)
      out.add({v * std::pow(times, kExponent), (times - 1) * rays * ray, uint16_t(times * n),
               noise.guided ? noise.guided->guided[i] : uint8_t(0)});
  const GuidedGroup* group = group_to_follow(noise, i);
  if (!group) return out;
  const double equal = v * std::pow(double(kFewestGuided) / n, kExponent);
  for (int level = 1; level <= kGuideLevels; ++level) {
    const GuidedGroup::Level& known = group->level(level);
    const double anew = double(known.rays);
    if (anew <= std::min(kMostAnew * n, double(max_samples)))
      out.add({equal * double(known.left), anew * ray, uint16_t(kFewestGuided), uint8_t(level)});
  }
  return out;
}

/// The choices that are the best for their cost, in steps: each lowers the variance more for a ray
/// than what comes after it (the lower convex hull).
void add_steps(const Choices& choices, double variance, ElementSteps& out) {
  double left = variance, cost = 0;
  for (;;) {
    const Choice* best = nullptr;
    double most = 0;
    for (size_t k = 0; k < choices.count; ++k) {
      const Choice& choice = choices.all[k];
      if (choice.cost <= cost) continue;
      const double gain = (left - choice.left) / (choice.cost - cost);
      if (gain > most) best = &choice, most = gain;
    }
    if (!best) return;
    out.more[out.count++] = {left - best->left, best->cost - cost, best->samples, best->guided};
    left = best->left, cost = best->cost;
  }
}

ElementSteps steps_of(const NoiseLeft& noise, const RayCosts& costs, int max_samples, size_t i) {
  ElementSteps out;
  if (noise.gathered[i] > 0)
    add_steps(choices_of(noise, costs.sample, max_samples, i), double(noise.gathered[i]), out);
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
    const auto add = [&](const RmsStep& step) {
      RmsStep& bin = bins[size_t(step.bin())];
      bin.gain += step.gain, bin.cost += step.cost;
    };
    for (const RmsStep& step : steps.of_rays()) add(step);
    if (steps.finer.helps()) add(steps.finer);
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
  if (noise.guided) out.anew.resize(n);
  const auto is_taken = [&](const RmsStep& step) { return step.helps() && step.bin() >= lowest; };
  for (size_t i = 0; i < n; ++i) {
    const ElementSteps steps = steps_of(noise, costs, max_samples, i);
    for (const RmsStep& step : steps.of_rays()) {
      if (!is_taken(step)) break;
      out.samples[i] = step.samples;
      if (noise.guided && step.guided != noise.guided->guided[i]) out.anew[i] = step.guided;
    }
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
