#include "luxel/solve/matrix/many_lights.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/vectorize.h"
#include "luxel/solve/matrix/row_sums.h"

namespace luxel::matrix {
namespace {

/// As many sums as AVX2 has registers for, beside the factor and what it is multiplied by, ...
constexpr size_t kLightsAtOnce = 16, kLightLanes = 8;
constexpr size_t kLightNumbers = 3 * kLightsAtOnce;

/// ... and the light of a patch in whole lines of the cache: light by light, channel by channel.
struct alignas(64) PatchLights {
  float value[kLightNumbers] = {};
};

/// out = sum_k factor_k lights_(column k).
LUXEL_VECTOR_CLONES
void sum_of_row(std::span<const uint32_t> column, std::span<const float> factor,
                const PatchLights* lights, PatchLights& out) {
  Float8 sum[kLightNumbers / kLightLanes] = {};
  add_products(column, factor, lights, sum);
  for (size_t v = 0; v < kLightNumbers / kLightLanes; ++v)
    store8(sum[v], out.value + v * kLightLanes);
}

/// Light of patches, patch by patch.
std::vector<PatchLights> packed(std::span<const std::span<const Rgb>> lights, size_t patches) {
  for (const std::span<const Rgb> light : lights) LUXEL_CHECK(light.size() == patches);
  std::vector<PatchLights> out(patches);
  parallel_for(patches, 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (size_t t = 0; t < lights.size(); ++t)
        for (int c = 0; c < 3; ++c) out[i].value[3 * t + size_t(c)] = lights[t][i][c];
  });
  return out;
}

/// E = F B of kLightsAtOnce lights or fewer.
void multiply_some(const FormFactors& factors, std::span<const std::span<const Rgb>> radiosity,
                   std::span<const std::span<Rgb>> irradiance) {
  const std::vector<PatchLights> lights = packed(radiosity, factors.size());
  parallel_for(factors.size(), 64, [&](size_t begin, size_t end) {
    PatchLights sum;
    for (size_t i = begin; i < end; ++i) {
      sum_of_row(factors.columns_of(i), factors.factors_of(i), lights.data(), sum);
      for (size_t t = 0; t < irradiance.size(); ++t)
        irradiance[t][i] = {sum.value[3 * t], sum.value[3 * t + 1], sum.value[3 * t + 2]};
    }
  });
}

/// The spans that products take.
std::vector<std::span<const Rgb>> sources(const ManyLights& lights) {
  return {lights.begin(), lights.end()};
}
std::vector<std::span<Rgb>> targets(ManyLights& lights) { return {lights.begin(), lights.end()}; }

}  // namespace

void multiply(const FormFactors& factors, std::span<const std::span<const Rgb>> radiosity,
              std::span<const std::span<Rgb>> irradiance) {
  LUXEL_CHECK(radiosity.size() == irradiance.size());
  for (size_t begin = 0; begin < radiosity.size(); begin += kLightsAtOnce) {
    const size_t count = std::min(kLightsAtOnce, radiosity.size() - begin);
    multiply_some(factors, radiosity.subspan(begin, count), irradiance.subspan(begin, count));
  }
}

Result<ManyLights> count_bounces(const FormFactors& factors, const SentByMany& sent, int bounces,
                                 Progress& progress) {
  const size_t n = factors.size(), lights = sent.radiosity.size();
  ManyLights out(lights, std::vector<Rgb>(n)), radiosity = out;
  for (int k = 0; k < bounces; ++k) {
    LUXEL_TRY_STATUS(stopped(progress));
    for (size_t t = 0; t < lights; ++t)
      for (size_t i = 0; i < n; ++i)
        radiosity[t][i] = sent.radiosity[t][i] + sent.reflectance[i] * out[t][i];
    multiply(factors, sources(radiosity), targets(out));
    progress.advance(1);
  }
  return out;
}

Result<ManyLights> all_bounces(const FormFactors& factors, const CoarseScene& coarse,
                               const SentByMany& sent, int sweeps,
                               const std::function<bool(const ManyLights&)>& see,
                               Progress& progress) {
  LUXEL_CHECK(sweeps >= 1);
  const size_t n = factors.size(), lights = sent.radiosity.size();
  ManyLights out(lights, std::vector<Rgb>(n));
  std::vector<BounceScratch> scratch(lights, make_bounce_scratch(n, coarse.count()));
  std::vector<std::span<Rgb>> first, gathered;
  std::vector<std::span<const Rgb>> radiosity;
  for (BounceScratch& s : scratch)
    first.push_back(s.first), gathered.push_back(s.gathered), radiosity.push_back(s.radiosity);
  multiply(factors, sources(sent.radiosity), first);
  for (size_t t = 0; t < lights; ++t) begin_sweeps(out[t], scratch[t]);
  progress.advance(1);
  for (int k = 1; k < sweeps && see(out); ++k) {
    LUXEL_TRY_STATUS(stopped(progress));
    for (size_t t = 0; t < lights; ++t)
      foresee(coarse, {sent.radiosity[t], sent.reflectance, sent.area_m2}, out[t], scratch[t]);
    multiply(factors, radiosity, gathered);
    for (size_t t = 0; t < lights; ++t) end_sweep(out[t], scratch[t]);
    progress.advance(1);
  }
  return out;
}

}  // namespace luxel::matrix
