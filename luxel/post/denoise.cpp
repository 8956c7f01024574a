#include "luxel/post/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/post/noise_level.h"
#include "luxel/post/oidn.h"
#include "luxel/post/outliers.h"

namespace luxel::post {
namespace {

/// A plane through the light around a texel: E(u, v) = value + u slope_u + v slope_v, u and v in
/// texels.
struct Plane {
  Rgb value, slope_u, slope_v;
  float variance = 0;        ///< of the value's luminance
  float slope_variance = 0;  ///< mean of both slopes'
};

/// Sums over a window: moments of weights and values, and of squared weights times variances.
struct Moments {
  float w = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  Rgb y{}, yu{}, yv{};
  float s = 0, su = 0, sv = 0, suu = 0, suv = 0, svv = 0;

  void add(const Neighbour& at, float weight, Rgb value, float variance) {
    const float wu = weight * at.u, wv = weight * at.v;
    w += weight, u += wu, v += wv;
    uu += wu * at.u, uv += wu * at.v, vv += wv * at.v;
    y += value * weight, yu += value * wu, yv += value * wv;
    const float q = weight * weight * variance, qu = q * at.u, qv = q * at.v;
    s += q, su += qu, sv += qv;
    suu += qu * at.u, suv += qu * at.v, svv += qv * at.v;
  }
};

/// Slopes are drawn to zero where positions spread by less than this [texels^2]: a row of texels
/// has no slope across it.
constexpr float kRidge = 0.02f;

/// Weighted least squares. Both the value and the slopes are linear in the texels' values: the
/// value is sum_j w_j (alpha + beta . x_j) y_j, hence its variance.
Plane fit(const Moments& m) {
  const float inverse = 1 / m.w;
  const float u = m.u * inverse, v = m.v * inverse;
  const Rgb y = m.y * inverse;
  const float uu = m.uu * inverse - u * u + kRidge, vv = m.vv * inverse - v * v + kRidge;
  const float uv = m.uv * inverse - u * v;
  const float det = 1 / (uu * vv - uv * uv);
  // Inverse of the spread, (a b; b c).
  const float a = vv * det, b = -uv * det, c = uu * det;
  const Rgb cu = m.yu * inverse - y * u, cv = m.yv * inverse - y * v;
  Plane plane;
  plane.slope_u = cu * a + cv * b;
  plane.slope_v = cu * b + cv * c;
  plane.value = y - plane.slope_u * u - plane.slope_v * v;

  const float bu = -(a * u + b * v) * inverse, bv = -(b * u + c * v) * inverse;
  const float alpha = inverse - bu * u - bv * v;
  plane.variance = alpha * alpha * m.s + 2 * alpha * (bu * m.su + bv * m.sv) + bu * bu * m.suu +
                   2 * bu * bv * m.suv + bv * bv * m.svv;
  // Second moments of squared weights about the mean place.
  const float tuu = m.suu - 2 * u * m.su + u * u * m.s;
  const float tvv = m.svv - 2 * v * m.sv + v * v * m.s;
  const float tuv = m.suv - u * m.sv - v * m.su + u * v * m.s;
  plane.slope_variance = 0.5f * inverse * inverse *
                         ((a * a + b * b) * tuu + 2 * b * (a + c) * tuv + (b * b + c * c) * tvv);
  return plane;
}

/// What a texel shows to its neighbours, side by side in memory.
struct Shown {
  Rgb estimate;
  float estimate_variance = 0;
  Rgb value;  ///< its own, unfiltered
  float variance = 0;
};

/// How well a neighbour's light agrees with the plane around a texel, 0 .. 1: the squared
/// difference over its variance, in the channel where it is largest. `per_limit`: one over the
/// largest ratio that counts, times each channel's variance over that of luminance.
float agreement(const Plane& own, const Shown& other, Rgb per_limit, const Neighbour& at) {
  const Rgb d = own.value + own.slope_u * at.u + own.slope_v * at.v - other.estimate;
  const float expected =
      own.variance + (at.u * at.u + at.v * at.v) * own.slope_variance + other.estimate_variance;
  const float rest = 1 - max_component(d * d * per_limit) / expected;
  return rest > 0 ? rest * (2 - rest) : 0.0f;
}

struct Round {
  float radius = 0;           ///< of the windows, in texels
  float max_deviations2 = 0;  ///< largest squared difference over its variance that counts
};
struct Planes {
  std::vector<Plane> planes;  ///< per texel
  std::vector<Shown> shown;   ///< what the others see of each: a buffer
};

/// One round: every texel's plane from the texels around it, weighted by how well the estimates of
/// the round before agree. What is shown is made anew from the planes, which are then replaced.
Status grow(const Neighbourhood& n, const NoiseLevel& noise, std::span<const Rgb> values,
            const Round& round, Planes& now, Progress& progress) {
  std::vector<Plane>& planes = now.planes;
  std::vector<Shown>& shown = now.shown;
  for (size_t i = 0; i < planes.size(); ++i)
    shown[i] = {planes[i].value, planes[i].variance, values[i], noise.variance[i]};
  parallel_for(values.size(), kBlockTexels, [&](size_t begin, size_t end) {
    if (progress.cancelled()) return;
    for (size_t i = begin; i < end; ++i) {
      if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
      const Plane own = planes[i];
      constexpr float kTiny = 1e-30f;  // a channel without noise agrees with its like alone
      const auto per = [&](float channel) {
        return 1 / (round.max_deviations2 * std::max(channel, kTiny));
      };
      const Rgb c = noise.per_channel[i], per_limit{per(c.x), per(c.y), per(c.z)};
      Moments moments;
      for_neighbours(n, uint32_t(i), round.radius, [&](uint32_t j, const Neighbour& at) {
        const float agree = j == i ? 1.0f : agreement(own, shown[j], per_limit, at);
        if (agree > 0) moments.add(at, at.weight * agree, shown[j].value, shown[j].variance);
      });
      planes[i] = fit(moments);
    }
    progress.advance(end - begin);
  });
  return stopped(progress);
}

/// Radii of the rounds: windows hold about 9, 21, 49, 113 and 253 texels.
constexpr float kRadii[] = {1.6f, 2.5f, 4, 6, 9};
/// The first round compares single texels: only what noise cannot explain at all is kept apart, so
/// that no outlier stands alone for ever.
constexpr float kFirstDeviations = 2;

/// Standard deviation over luminance, 1 at most: black has no colour to be given light in.
float relative_noise(Rgb value, float variance) {
  const float l = luminance(value);
  return l > 0 ? std::min(1.0f, std::sqrt(variance) / l) : 0.0f;
}

/// No more than this part of the light is given back: more is not the skew of noise.
constexpr double kMostGivenBack = 0.2;

/// Sums of values, and of values times relative noise, over texels that have noise.
struct Balance {
  std::array<double, 3> light{}, noise{};
};
Balance balance_of(const Neighbourhood& n, const NoiseLevel& noise, std::span<const Rgb> values) {
  Balance sum;
  for (size_t i = 0; i < values.size(); ++i) {
    if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
    const float relative = relative_noise(values[i], noise.variance[i]);
    for (int c = 0; c < 3; ++c) {
      sum.light[size_t(c)] += double(values[i][c]);
      sum.noise[size_t(c)] += double(values[i][c] * relative);
    }
  }
  return sum;
}

/// Gives back what the filter has taken from the sum of the light, or takes what it has added, in
/// proportion to light and to how noisy it was. Noise of few samples is skewed, and planes through
/// what agrees lean towards its median, by as much as there is noise.
void keep_sum(const Neighbourhood& n, const NoiseLevel& noise, const Balance& before,
              std::span<Rgb> values) {
  const Balance after = balance_of(n, noise, values);
  const auto share = [&](size_t c) {
    if (!(after.noise[c] > 0)) return 0.0f;
    return float(std::clamp((before.light[c] - after.light[c]) / after.noise[c], -kMostGivenBack,
                            kMostGivenBack));
  };
  const Rgb factor{share(0), share(1), share(2)};
  for (size_t i = 0; i < values.size(); ++i) {
    if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
    values[i] += values[i] * factor * relative_noise(values[i], noise.variance[i]);
  }
}

/// The fireflies of a part; of direct light those that are none on a closer look left out.
Result<std::vector<Firefly>> fireflies_of(const Neighbourhood& n, const NoiseLevel& noise,
                                          const NoisyLight& part) {
  if (part.is_direct && !part.look_again) return std::vector<Firefly>{};
  std::vector<Firefly> found =
      find_fireflies(n, {part.values, part.variance, noise, part.is_direct});
  if (!part.is_direct || found.empty()) return found;
  std::vector<uint32_t> texels;
  for (const Firefly& f : found) texels.push_back(f.texel);
  LUXEL_TRY(const std::vector<Rgb> seen, part.look_again(texels));
  LUXEL_CHECK(seen.size() == found.size());
  for (size_t k = 0; k < found.size(); ++k) found[k].luminance = luminance(seen[k]);
  std::erase_if(found,
                [&](const Firefly& f) { return !(f.luminance < luminance(part.values[f.texel])); });
  return found;
}

/// Filters one part in place.
Status filter(const Neighbourhood& n, const DenoiseParams& params, const NoisyLight& part,
              Progress& progress) {
  const NoiseLevel noise = noise_level(n, part.values, part.variance);
  const Balance before = balance_of(n, noise, part.values);
  LUXEL_TRY(const std::vector<Firefly> fireflies, fireflies_of(n, noise, part));
  share_out(n, part.variance, fireflies, part.values);
  Planes planes{std::vector<Plane>(part.values.size()), std::vector<Shown>(part.values.size())};
  std::vector<Plane>& now = planes.planes;
  for (size_t i = 0; i < now.size(); ++i) now[i] = {part.values[i], {}, {}, noise.variance[i], 0};
  float deviations = params.max_deviations * kFirstDeviations;
  for (const float radius : kRadii) {
    if (radius > params.radius) break;
    LUXEL_TRY_STATUS(
        grow(n, noise, part.values, {radius, deviations * deviations}, planes, progress));
    deviations = params.max_deviations;
  }
  for (size_t i = 0; i < now.size(); ++i) {
    if (n.place[i].spacing <= 0 || noise.variance[i] <= 0) continue;
    if (is_finite(now[i].value)) part.values[i] = max(now[i].value, Rgb{});
  }
  keep_sum(n, noise, before, part.values);
  return {};
}

}  // namespace

Status denoise(const TexelGeometry& places, std::span<const NoisyLight> parts,
               const DenoiseParams& params, Progress& progress) {
  for (const NoisyLight& part : parts) {
    LUXEL_CHECK(part.values.size() == places.map.texels.size());
    LUXEL_CHECK(part.variance.size() == part.values.size());
    for (const Rgb& v : part.values) LUXEL_CHECK(is_finite(v) && min_component(v) >= 0);
    for (const float v : part.variance) LUXEL_CHECK(std::isfinite(v) && v >= 0);
  }
  progress.begin("denoise", parts.size() * places.map.texels.size() * std::size(kRadii));
  if (kHasOidn) return denoise_with_oidn(places, parts, progress);
  LUXEL_TRY(const Neighbourhood n, make_neighbourhood(places, params, progress));
  for (const NoisyLight& part : parts) LUXEL_TRY_STATUS(filter(n, params, part, progress));
  return {};
}

}  // namespace luxel::post
