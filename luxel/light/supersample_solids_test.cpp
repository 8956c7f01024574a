#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "luxel/light/supersample.h"
#include "luxel/transport/floor_test_support.h"
#include "luxel/transport/visible_samples.h"

namespace luxel::light {
namespace {

/// Direct light is averaged over the judge's points, which leave out those under the shell also
/// where the lamp reaches them.
TEST(Supersample, LightIsAveragedOverPlacesInTheOpen) {
  transport::Floor floor = transport::floor_under_a_shell();
  const trace::RayTracer rays = floor.tracer();
  floor.move_samples(rays);
  const transport::Elements elements =
      transport::elements_from_texels(floor.scene, floor.atlas, floor.map);
  const Lights lights = collect_lights(floor.scene);
  const size_t n = elements.size();
  Progress progress;
  SupersampleParams params;
  params.direct = {8, 1};
  const auto judge = footprints({floor.scene, floor.atlas, floor.map, elements, lights, rays},
                                params.points, params.direct.seed, progress);
  ASSERT_TRUE(judge);
  DirectLight direct;
  direct.irradiance.assign(n, Rgb{1, 1, 1}), direct.variance.resize(n);
  direct.split_variance.resize(n);
  std::vector<uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0);
  ASSERT_TRUE(average_texels({floor.scene, floor.atlas, floor.map, elements, lights, rays}, all,
                             params, direct, progress));
  size_t partly = 0;
  for (size_t i = 0; i < n; ++i) {
    const size_t first = judge->first[i], count = judge->first[i + 1] - first;
    if (count < 2 || count == size_t(params.points)) continue;  // 1: its own, maybe inside
    ++partly;
    float sum = 0;
    for (size_t k = first; k < first + count; ++k) {
      const Vec3 from = judge->points.position[k] + Vec3{0, 1e-5f, 0}, to = transport::kLamp - from;
      const trace::Ray ray{from, 0, normalize(to), length(to)};
      std::array<trace::Hit, 1> hit;
      rays.closest_hits(std::span(&ray, 1), hit);
      if (!hit[0].found()) sum += to.y / (length(to) * dot(to, to));
    }
    // Rays start a little above the floor: 1e-5 of the lamp's height.
    EXPECT_NEAR(direct.irradiance[i].x, sum / float(count), 1e-3f * sum / float(count)) << i;
  }
  EXPECT_GT(partly, 20u);
}

}  // namespace
}  // namespace luxel::light
