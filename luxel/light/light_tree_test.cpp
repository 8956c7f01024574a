#include "luxel/light/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/light/light_draw.h"
#include "luxel/light/lights.h"

namespace luxel::light {
namespace {

Vec3 random_direction(RandomStream& random) {
  const Vec2 u = random.next2();
  const float z = 1 - 2 * u.y, r = std::sqrt(std::max(0.0f, 1 - z * z));
  return {r * std::cos(2 * kPi * u.x), r * std::sin(2 * kPi * u.x), z};
}
Vec3 random_point(RandomStream& random) {
  return Vec3{random.next(), random.next(), random.next()} * 4.0f - Vec3{2, 2, 2};
}

/// `count` lamps of all kinds, their directions within a quarter turn of one another in places.
scene::Scene lamps(int count, uint64_t seed) {
  scene::Scene scene;
  RandomStream random{seed};
  for (int i = 0; i < count; ++i) {
    scene::PunctualLight lamp;
    lamp.position = random_point(random);
    lamp.intensity = Rgb{1, 1, 1} * (0.1f + random.next());
    lamp.direction = normalize(random_direction(random) + Vec3{0, lamp.position.x, 0});
    if (i % 3 != 0) lamp.kind = scene::PunctualLight::Kind::spot;
    lamp.outer_cone_rad = 0.05f + 1.5f * random.next();
    lamp.inner_cone_rad = 0.5f * lamp.outer_cone_rad;
    if (i % 4 == 0) lamp.range_m = 0.5f + random.next();
    scene.lights.push_back(lamp);
  }
  return scene;
}

float brings(const Lights& lights, uint32_t leaf, Vec3 position, Vec3 normal) {
  const auto in =
      incidence_at(lights.punctual[lights.punctual_order[leaf]], lights.profiles, position);
  return luminance(in.irradiance) * std::max(0.0f, dot(in.towards, normal));
}

// A group that is held for dark is never looked into: one of its lights that shines would be lost.
// Cones of spots, ranges and horizons, against each lamp by itself.
TEST(LightTree, IsDarkOnlyWhereEveryLightIs) {
  RandomStream random{5};
  size_t dark = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Lights lights = collect_lights(lamps(24, seed));
    for (int k = 0; k < 200; ++k) {
      const Vec3 x = random_point(random), n = random_direction(random);
      for (const LightNode& node : lights.punctual_nodes) {
        if (importance_at(node, x, n) > 0) continue;
        ++dark;
        for (uint32_t i = node.first; i < node.first + node.count; ++i)
          EXPECT_EQ(brings(lights, i, x, n), 0) << "node of " << node.count;
      }
    }
  }
  // The bounds do find darkness: about half of all pairs of a point and a single lamp.
  EXPECT_GT(dark, 50'000u);
}

// sum over lights of (value / chance): its mean over many starts is the sum over all lights, for
// any values, here those of the lamps and 1 where a lamp brings anything. The starts are spread
// evenly, so that the mean errs only where a light is longer than 1 on the line for one of them.
TEST(LightDraw, EveryLightIsDrawnAsOftenAsItsChanceSays) {
  const Lights lights = collect_lights(lamps(300, 3));
  const Vec3 x{0.1f, -1, 0.3f}, n{0, 1, 0};
  const LeafImportance leaf = [&](const LightNode& node) { return importance_at(node, x, n); };
  double light = 0, number = 0, expected_light = 0, expected_number = 0, draws = 0;
  for (uint32_t i = 0; i < lights.punctual_order.size(); ++i) {
    const double e = double(brings(lights, i, x, n));
    expected_light += e, expected_number += e > 0;
  }
  ASSERT_GT(expected_number, 20);
  LightDraws drawn;
  constexpr int kStarts = 20'000;
  for (int k = 0; k < kStarts; ++k) {
    draw_lights(lights.punctual_nodes, x, n, leaf,
                {.samples = 16, .start = (float(k) + 0.5f) / kStarts}, drawn);
    for (const LightDraw& d : drawn.draws) {
      const double e = double(brings(lights, d.light, x, n));
      light += e / double(d.chance), number += (e > 0) / double(d.chance), draws += d.count;
    }
  }
  // Each light is hit by a whole number of starts: off by one of chance * kStarts, and chances of
  // what matters are above 1 %.
  EXPECT_NEAR(light / kStarts / expected_light, 1, 0.005);
  EXPECT_NEAR(number / kStarts / expected_number, 1, 0.005);
  // Rays of groups that turn out dark on the way down are lost: two thirds of these lamps are spots
  // that look anywhere. Rounding the certain lights' rays adds one at most.
  EXPECT_LE(draws / kStarts, 17);
  EXPECT_GT(draws / kStarts, 8);
}

}  // namespace
}  // namespace luxel::light
