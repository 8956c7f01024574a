#include "luxel/solve/matrix/glow.h"

#include <algorithm>
#include <functional>
#include <map>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/light/direct_light.h"
#include "luxel/solve/matrix/probes.h"

namespace luxel::matrix {
namespace {

/// Shadow rays per probe: with eight probes, 128 per patch. The visible share of a lamp is a ratio
/// of sums, which so few rays overestimate by 0.2 %.
constexpr int kGlowSamples = 16;

/// Where a channel is above 0.
Rgb one_over(Rgb c) {
  const auto inverse = [](float v) { return v > 0 ? 1 / v : 0; };
  return {inverse(c.x), inverse(c.y), inverse(c.z)};
}

/// A material that takes more than this part of the surfaces is left to the rays of the patches,
/// which find all of it: shadow rays towards lamps all around are less even.
constexpr float kMostOfAll = 0.5f;

/// E of all patches per material, where it sends any.
using Columns = std::map<uint32_t, std::vector<Rgb>>;

/// Channels of `a` in which a material glows, and of `b` in others.
Rgb where_it_glows(Rgb mean, Rgb a, Rgb b) {
  return {mean.x > 0 ? a.x : b.x, mean.y > 0 ? a.y : b.y, mean.z > 0 ? a.z : b.z};
}

/// The scene with this material alone glowing.
light::Lights lights_of(scene::Scene& dark, const scene::Scene& scene, uint32_t material) {
  dark.materials[material].emission = scene.materials[material].emission;
  light::Lights lights = light::collect_lights(dark);
  dark.materials[material].emission = {};
  return lights;
}

/// Nothing in the scene shines.
scene::Scene darkened(const scene::Scene& scene) {
  scene::Scene dark = scene;
  for (scene::Material& m : dark.materials) m.emission = {};
  dark.lights.clear(), dark.background = {}, dark.environment = {};
  return dark;
}

/// Light of the materials that glow in the scene, for a mean radiosity of 1 in every channel that
/// they have.
Result<Columns> traced_glow(const scene::Scene& scene, const trace::RayTracer& tracer,
                            const Prepared& prepared, std::span<const Rgb> mean,
                            const light::DirectParams& params, Progress& progress) {
  const Patches& patches = prepared.patched.patches;
  const Probes probes = probes_of(patches);
  scene::Scene dark = darkened(scene);
  Columns out;
  std::vector<float> area(mean.size());
  float all = 0;
  for (size_t i = 0; i < patches.size(); ++i)
    area[patches.material[i]] += patches.area_m2[i], all += patches.area_m2[i];
  for (uint32_t m = 0; m < mean.size(); ++m) {
    if (max_component(mean[m]) <= 0 || area[m] > kMostOfAll * all) continue;
    LUXEL_TRY(const light::DirectLight direct,
              light::direct_light(scene, probes.elements, lights_of(dark, scene, m), tracer, params,
                                  progress));
    std::vector<Rgb> column = mean_at_patches(probes, direct.irradiance);
    for (Rgb& e : column) e = where_it_glows(mean[m], e * one_over(mean[m]), {});
    out.emplace(m, std::move(column));
  }
  return out;
}

}  // namespace

std::vector<Rgb> mean_emission_of(std::span<const Rgb> emission, std::span<const uint32_t> material,
                                  std::span<const float> area_m2, size_t materials) {
  std::vector<Rgb> mean(materials);
  std::vector<float> area(materials);
  for (size_t i = 0; i < emission.size(); ++i)
    mean[material[i]] += emission[i] * area_m2[i], area[material[i]] += area_m2[i];
  for (size_t m = 0; m < mean.size(); ++m)
    if (area[m] > 0) mean[m] = mean[m] / area[m];
  return mean;
}

Result<Glow> make_glow(const scene::Scene& scene, const trace::RayTracer& tracer,
                       const Prepared& prepared, uint64_t seed, Progress& progress) {
  const Patches& patches = prepared.patched.patches;
  const std::vector<Rgb> mean =
      mean_emission_of(patches.emission, patches.material, patches.area_m2, scene.materials.size());
  LUXEL_TRY(const Columns traced, traced_glow(scene, tracer, prepared, mean,
                                              {.samples = kGlowSamples, .seed = seed}, progress));
  std::vector<Rgb> pattern(patches.size());
  for (size_t j = 0; j < pattern.size(); ++j) {
    const Rgb of_all = mean[patches.material[j]];
    pattern[j] = where_it_glows(of_all, patches.emission[j] * one_over(of_all), {1, 1, 1});
  }
  // Row by row: what rays found of each material, or what shadow rays did.
  Glow out;
  out.first.push_back(0);
  std::vector<Rgb> sum(mean.size());
  for (size_t i = 0; i < patches.size(); ++i) {
    std::fill(sum.begin(), sum.end(), Rgb{});
    const auto columns = prepared.factors.columns_of(i);
    const auto factors = prepared.factors.factors_of(i);
    for (size_t k = 0; k < columns.size(); ++k)
      sum[patches.material[columns[k]]] += factors[k] * pattern[columns[k]];
    for (const auto& [m, column] : traced) sum[m] = where_it_glows(mean[m], column[i], sum[m]);
    for (uint32_t m = 0; m < sum.size(); ++m)
      if (max_component(sum[m]) > 0) out.material.push_back(m), out.irradiance.push_back(sum[m]);
    out.first.push_back(uint32_t(out.material.size()));
  }
  return out;
}

void add_glow(const Glow& glow, std::span<const Rgb> radiosity, std::span<Rgb> irradiance) {
  LUXEL_CHECK(glow.first.size() == irradiance.size() + 1);
  const auto patches = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (uint32_t k = glow.first[i]; k < glow.first[i + 1]; ++k)
        irradiance[i] += glow.irradiance[k] * radiosity[glow.material[k]];
  };
  parallel_for(irradiance.size(), 1024, std::ref(patches));
}

}  // namespace luxel::matrix
