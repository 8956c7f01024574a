#include "luxel/pipeline/bake/denoise_light.h"

#include <numeric>

#include "luxel/base/check.h"
#include "luxel/pipeline/texels/texel_layout.h"
#include "luxel/post/denoise.h"

namespace luxel::pipeline {
namespace {

/// Per chart, the least number of those that it hangs together with by open seams. `max_angle_rad`:
/// of the normals on both sides of a seam.
std::vector<uint32_t> regions_of(const light::TexelScene& in, float max_angle_rad) {
  std::vector<uint32_t> least(in.atlas.chart_count);
  std::iota(least.begin(), least.end(), 0u);
  const auto root = [&](uint32_t chart) {
    while (least[chart] != chart) chart = least[chart] = least[least[chart]];
    return chart;
  };
  const std::vector<post::Seam> seams = open_seams(
      in.scene, in.atlas, in.tracer, post::find_seams(in.scene, in.atlas, max_angle_rad));
  for (const post::Seam& s : seams) {
    const uint32_t a = root(in.atlas.chart[s.triangle_a]), b = root(in.atlas.chart[s.triangle_b]);
    least[std::max(a, b)] = std::min(a, b);
  }
  for (uint32_t chart = 0; chart < least.size(); ++chart) least[chart] = root(chart);
  return least;
}

}  // namespace

Status denoise_light(const light::TexelScene& in, bool repair_leaks, TexelLight& light,
                     Progress& progress) {
  LUXEL_CHECK(light.variance.size() == light.irradiance.size());
  const post::DenoiseParams params;
  std::vector<uint32_t> regions;
  if (repair_leaks) regions = regions_of(in, params.max_normal_angle_rad);
  const post::TexelGeometry places{.scene = in.scene,
                                   .atlas = in.atlas,
                                   .map = in.map,
                                   .position = in.elements.position,
                                   .normal = in.elements.normal,
                                   .hidden = light.hidden,
                                   .region = regions};
  std::vector<Rgb> rest = light.irradiance;
  // A difference of rounded sums may fall below zero.
  for (size_t i = 0; i < light.direct.size(); ++i)
    rest[i] = max(light.irradiance[i] - light.direct[i], Rgb{});
  std::vector<post::NoisyLight> parts{{rest, light.variance}};
  if (!light.direct.empty()) parts.push_back({light.direct, light.direct_variance, true});
  LUXEL_TRY_STATUS(post::denoise(places, parts, params, progress));
  for (size_t i = 0; i < light.direct.size(); ++i) rest[i] += light.direct[i];
  light.irradiance = std::move(rest);
  return {};
}

}  // namespace luxel::pipeline
