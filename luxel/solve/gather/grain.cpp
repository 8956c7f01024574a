// More rays where the denoiser would leave light mottled.
//
// The filter takes means over windows whose noise is independent, so the root of the number of
// texels is what it gains at most. Where little of what rays meet is bright, as in the shade of a
// court in the sun or in a room that a spot's circle lights, blotches are left, as wide as the
// window. Rays that follow a guide find that little.
#include <algorithm>
#include <cmath>

#include "luxel/base/random.h"
#include "luxel/solve/gather/bounce/ambient.h"
#include "luxel/solve/gather/bounce/sweep.h"
#include "luxel/solve/gather/budget/adaptive.h"
#include "luxel/solve/gather/budget/guide.h"
#include "luxel/solve/gather/steps.h"
#include "luxel/transport/texel_width.h"

namespace luxel::gather {
namespace {

/// The standard error over the light that the filter may leave. An eye sees 1 % of a smooth wall.
constexpr double kGrainLeft = 0.006;
/// Rays that are added are this part of all at most.
constexpr double kMostAdded = 0.45;
constexpr int kMostSamples = 16384;
/// Sweeps over some of the rays, from which all light is known well enough to tell what is bright.
constexpr int kRoughSweeps = 6;
constexpr size_t kRoughStride = 16;
/// Surfaces are looked at in cells of so many texels along each side, which face alike.
constexpr float kCellTexels = 8;
/// The filter's last window has 254 texels; by the squares of its weights they count as 190.
constexpr double kWindowTexels = 254, kWindowCounts = 190;
/// The filter's errors over those of such a mean: it leaves out texels that differ by chance.
constexpr double kFilterLoses = 1.6;

/// Elements that share light in the denoiser.
struct AlikeElements {
  std::vector<uint32_t> elements;
  double variance = 0, light = 0;  ///< means: of the luminance's variance, of luminance

  /// The part of a standard error that the filter leaves.
  double left() const {
    const double per_texel = kWindowTexels / double(kCellTexels * kCellTexels);
    const double window = std::min(kWindowTexels, per_texel * double(elements.size()));
    return std::min(1.0, kFilterLoses * std::sqrt(kWindowTexels / (kWindowCounts * window)));
  }
};

/// The cell of an element: by its place, in units of its texels, and by the way that it faces.
uint64_t alike_cell(const light::TexelScene& in, size_t i) {
  const scene::SurfacePoint& p = in.map.texels[i].sample;
  const float width = transport::texel_width_m(in.scene, in.atlas, p.instance, p.triangle);
  const int level = width > 0 ? std::ilogb(width) : 0;
  const float side = std::ldexp(kCellTexels, level);
  const Vec3 at = in.elements.position[i] / side, n = in.elements.normal[i] * 2;
  uint64_t key = hash64(0x9a11, uint64_t(level));
  for (const float x : {at.x, at.y, at.z}) key = hash64(key, uint64_t(int64_t(std::floor(x))));
  for (const float x : {n.x, n.y, n.z}) key = hash64(key, uint64_t(int64_t(std::lround(x))));
  return key;
}

/// About what all elements gather, and how well it is known: of a guess of what surfaces send.
struct Guessed {
  std::vector<Rgb> irradiance;
  std::vector<float> variance;
};
/// Errors: the file of hits cannot be read, cancelled.
Result<Guessed> look_at_guess(const Request& in, const Progressive& light, Progress& progress) {
  const light::TexelScene& scene = in.scene;
  Guessed out{with_ambient(scene.elements, light.direct.irradiance), {}};
  RadiosityMap sent = empty_radiosity_map(scene.map.resolution);
  fill_radiosity(sent, scene.map, scene.elements, light.hits, in.behind, out.irradiance);
  for (int k = 0; k < kRoughSweeps; ++k) {
    Sweep rough{.direct = light.direct.irradiance, .irradiance = out.irradiance};
    rough.stride = light.hits.device ? 1 : kRoughStride;
    LUXEL_TRY_STATUS(run_sweep(sent, light.hits, rough, progress));
    fill_radiosity(sent, scene.map, scene.elements, light.hits, in.behind, out.irradiance);
  }
  std::vector<float> independent(light.hits.size()), split(light.hits.size());
  Sweep sweep{.direct = light.direct.irradiance,
              .irradiance = out.irradiance,
              .variance = independent,
              .split_variance = split};
  LUXEL_TRY_STATUS(run_sweep(sent, light.hits, sweep, progress));
  LUXEL_TRY_STATUS(give_variances(light.hits, independent, split, progress));
  out.variance = pooled_variances(scene.atlas, scene.map, {independent, split});
  return out;
}

std::vector<AlikeElements> alike_elements(const Request& in, const TracedHits& hits,
                                          const Guessed& light) {
  std::vector<std::pair<uint64_t, uint32_t>> order;
  for (uint32_t i = 0; i < hits.size(); ++i)
    if (!is_hidden(hits, i)) order.push_back({alike_cell(in.scene, i), i});
  std::ranges::sort(order);
  std::vector<AlikeElements> out;
  for (size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || order[k].first != order[k - 1].first) out.emplace_back();
    const uint32_t i = order[k].second;
    out.back().elements.push_back(i);
    out.back().variance += double(light.variance[i]);
    out.back().light += double(luminance(light.irradiance[i]));
  }
  for (AlikeElements& a : out)
    a.variance /= double(a.elements.size()), a.light /= double(a.elements.size());
  return out;
}

/// Per element, the square of what the filter leaves of its standard error, over its light; 0 where
/// nobody sees that.
std::vector<float> grain_of(const Request& in, const TracedHits& hits, const Guessed& light) {
  std::vector<float> out(hits.size());
  const double darkest = double(darkest_light(light.irradiance));
  if (!(darkest > 0)) return out;
  for (const AlikeElements& cell : alike_elements(in, hits, light)) {
    const double left =
        cell.left() * std::sqrt(double(kOfNoise) * cell.variance) / std::max(cell.light, darkest);
    if (left <= kGrainLeft) continue;
    for (const uint32_t i : cell.elements) out[i] = float(left * left);
  }
  return out;
}

/// Rays where what the filter leaves falls most for them, until it is kGrainLeft.
RoundPlan plan_grain(const Request& in, std::span<const float> grain, const Progressive& light) {
  const size_t n = grain.size();
  const auto grainy = std::ranges::count_if(grain, [](float g) { return g > 0; });
  const std::vector<float> none(n);
  const light::DirectLevels levels{std::vector<uint8_t>(n), std::vector<uint8_t>(n)};
  const RayCosts costs = costs_of(in, light);
  const double samples = double(sum_of(light.hits.samples));
  return plan_rms_round({grain, none, light.hits.samples, levels, &light.hits},
                        double(grainy) * kGrainLeft * kGrainLeft,
                        kMostAdded * samples * costs.sample, costs, kMostSamples);
}

}  // namespace

Status add_where_grainy(const Request& in, Progressive& light, Progress& progress) {
  if (!in.params.more_rays || in.adds_rounds() || in.knows_rays_by_number()) return {};
  LUXEL_TRY(const Guessed guessed, look_at_guess(in, light, progress));
  const std::vector<float> grain = grain_of(in, light.hits, guessed);
  if (std::ranges::none_of(grain, [](float g) { return g > 0; })) return {};
  Progress own;  // its stages are not those of the bake
  LUXEL_TRY(light.hits.guide,
            make_guide(in.scene, in.sides,
                       {light.hits, in.behind, guessed.irradiance, in.stores.team, grain},
                       in.params.seed, own));
  LUXEL_TRY_STATUS(stopped(progress));
  const RoundPlan plan = plan_grain(in, grain, light);
  begin_anew(plan.anew, light.hits);
  return trace_round(in, plan.samples, light, progress);
}

}  // namespace luxel::gather
