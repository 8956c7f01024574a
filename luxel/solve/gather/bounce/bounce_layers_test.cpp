// Layers of light: they add up, and each is what its lights alone would give.
#include "luxel/solve/gather/bounce/bounce_layers.h"

#include <gtest/gtest.h>

#include "luxel/base/parallel.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/trace/trace_hits.h"

namespace luxel::gather {
namespace {

/// Two lamps without area, a panel that shines, a sky that comes in through a hole in the wall, and
/// a block that throws shadows.
scene::Scene lit_room() {
  scene::Scene s = scene::cornell_box();
  s.background = {0.3f, 0.4f, 0.6f};
  const Box3 bounds = scene::world_bounds(s);
  const Vec3 size = bounds.upper - bounds.lower;
  const auto at = [&](float x, float y, float z) {
    return bounds.lower + Vec3{size.x * x, size.y * y, size.z * z};
  };
  s.lights.resize(2);
  s.lights[0].name = "left", s.lights[0].position = at(0.2f, 0.8f, 0.7f);
  s.lights[0].intensity = Rgb{0.5f, 0.2f, 0.1f} * 0.3f;
  s.lights[1].name = "right", s.lights[1].position = at(0.8f, 0.6f, 0.3f);
  s.lights[1].intensity = Rgb{0.1f, 0.2f, 0.4f} * 0.3f;
  return s;
}

light::LightLayers layers_of(const Room& room) {
  auto layers = light::light_layers(room.scene, room.lights, light::LayerMode::per_light);
  EXPECT_TRUE(layers) << layers.error().message;
  return *layers;
}

double mean_of(std::span<const Rgb> light) {
  double mean = 0;
  for (const Rgb& e : light) mean += double(luminance(e)) / double(light.size());
  return mean;
}

/// The largest difference of a channel, relative to the larger of the value and the mean.
double largest_difference(std::span<const Rgb> a, std::span<const Rgb> b) {
  const double mean = mean_of(b);
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const Rgb d = max(a[i] - b[i], b[i] - a[i]);
    for (const auto& [difference, value] : {std::pair{d.x, b[i].x}, {d.y, b[i].y}, {d.z, b[i].z}})
      largest = std::max(largest, double(difference) / std::max(double(value), mean));
  }
  return largest;
}

/// Root mean square over the mean.
double rms_difference(std::span<const Rgb> a, std::span<const Rgb> b) {
  double sum2 = 0;
  for (size_t i = 0; i < a.size(); ++i) sum2 += double(dot(a[i] - b[i], a[i] - b[i])) / 3;
  return std::sqrt(sum2 / double(a.size())) / mean_of(b);
}

std::vector<Rgb> sum_of(const std::vector<std::vector<Rgb>>& layers) {
  std::vector<Rgb> sum(layers[0].size());
  for (const std::vector<Rgb>& layer : layers)
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += layer[i];
  return sum;
}

// Light adds up. The bits of the whole are those without layers, and what had to be shared out to
// make the sum of four layers whole is small: that the layers know it by themselves is the test of
// sources and sweeps, for shared out it would hide a layer that is missing. With one bounce and
// none there is no noise of sparse sweeps and nothing but rounding.
TEST(GatherLayers, AddUpToTheWhole) {
  const auto room = lay_out(lit_room(), 64);
  const light::LightLayers layers = layers_of(*room);
  ASSERT_EQ(layers.size(), 4u);
  for (const auto& [bounces, most_shared] :
       {std::pair{-1, 5e-3}, {0, 1e-6}, {1, 1e-5}, {3, 5e-3}}) {
    GatherParams params = with_samples(64, 16);
    params.supersample = 4, params.bounces = bounces;
    const Gather alone = solve(*room, params);
    const Gather result = solve(*room, params, {}, &layers);
    EXPECT_EQ(result.irradiance, alone.irradiance);
    EXPECT_TRUE(alone.layers.empty());
    ASSERT_EQ(result.layers.size(), layers.size());
    // Four sums and a quotient in floats.
    EXPECT_LT(largest_difference(sum_of(result.layers), result.irradiance), 1e-6) << bounces;
    EXPECT_LT(result.layers_shared_out, most_shared) << bounces;
    for (const std::vector<Rgb>& layer : result.layers) {
      EXPECT_GT(mean_of(layer), 0.001 * mean_of(result.irradiance));
      for (const Rgb& e : layer) ASSERT_GE(min_component(e), 0.0f);
    }
  }
}

// Where there is no memory for a copy of the hits that sparse sweeps look at, those themselves give
// the same bits.
TEST(GatherLayers, DoNotDependOnTheCopyOfHits) {
  const auto room = lay_out(scene::cornell_box(), 32);
  const size_t n = room->elements.size();
  Progress progress;
  const auto hits = trace_hits(trace_scene(scene_of(*room)), 256, {}, progress);
  ASSERT_TRUE(hits);
  std::vector<Rgb> both(n), layered(2 * n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 p = room->elements.position[i];
    layered[2 * i] = {p.x, 1, 0}, layered[2 * i + 1] = {0, p.y, 1};
    both[i] = layered[2 * i] + layered[2 * i + 1];
  }
  const auto whole = bounce(room->map, room->elements, *hits, both, {}, {}, progress);
  ASSERT_TRUE(whole);
  const auto bounced = [&](uint64_t spare_bytes) {
    return bounce_layers(room->map, room->elements, *hits, {}, {layered, whole->irradiance},
                         {.spare_bytes = spare_bytes}, progress);
  };
  const auto with = bounced(UINT64_MAX), without = bounced(0);
  ASSERT_TRUE(with && without);
  EXPECT_EQ(with->irradiance, without->irradiance);
  // The layers know by themselves what they add up to.
  EXPECT_LT(with->shared_out, 5e-3);
}

// Lamps without area are exact, and so their direct light, and the rays are those of the whole: a
// bake of each lamp alone has the same E_0 and the same rays, but for those that are followed on,
// which see other shadow rays. What is left is the noise of sparse sweeps. The Cornell box's
// reflectances bring half of the light by bounces.
TEST(GatherLayers, AreWhatEachLightAloneGives) {
  const scene::Scene both = [] {
    scene::Scene s = lit_room();
    s.background = {};
    for (scene::Material& m : s.materials) m.emission = {};
    return s;
  }();
  const auto room = lay_out(both, 64);
  const light::LightLayers layers = layers_of(*room);
  ASSERT_EQ(layers.size(), 2u);
  const GatherParams params = with_samples(256, 16);
  const Gather result = solve(*room, params, {}, &layers);
  for (size_t l = 0; l < 2; ++l) {
    scene::Scene one = both;
    one.lights = {both.lights[l]};
    const auto alone = lay_out(one, 64);
    const Gather expected = solve(*alone, params);
    EXPECT_LT(rms_difference(result.layers[l], expected.irradiance), 3e-3) << l;
    EXPECT_LT(largest_difference(result.layers[l], expected.irradiance), 2e-2) << l;
    // Against what the bake itself is uncertain by.
    EXPECT_LT(rms_difference(result.layers[l], expected.irradiance), 0.3 * expected.relative_error);
  }
}

// Backs that shine by the light behind them, rounds of more samples, and twelve layers, which are
// more than two blocks hold.
TEST(GatherLayers, AddUpInEveryKindOfScene) {
  scene::Scene s = lit_room();
  const Box3 bounds = scene::world_bounds(s);
  for (int k = 0; k < 8; ++k) {
    s.lights.push_back(s.lights[size_t(k % 2)]);
    s.lights.back().position.x =
        bounds.lower.x + (0.1f + 0.1f * float(k)) * (bounds.upper.x - bounds.lower.x);
  }
  const size_t mesh = s.instances[0].mesh;
  s.materials[s.meshes[mesh].triangle_material[0]].diffuse_transmission = 0.4f;
  scene::add_backs(s, uint32_t(mesh), std::vector<uint8_t>(s.meshes[mesh].triangles.size(), 1));
  const auto room = lay_out(s, 64);
  const light::LightLayers layers = layers_of(*room);
  ASSERT_EQ(layers.size(), 12u);
  // From 256 samples on sparse sweeps read a copy of every 16th hit.
  for (const auto& [samples, max_error] : {std::pair{32, 0.05f}, {256, 0.01f}}) {
    GatherParams params = with_samples(samples, 8);
    params.max_error = max_error, params.max_samples = 8 * samples;
    const Gather result = solve(*room, params, {}, &layers);
    EXPECT_GT(*std::ranges::max_element(result.samples), samples);
    EXPECT_LT(largest_difference(sum_of(result.layers), result.irradiance), 2e-6);
    EXPECT_LT(result.layers_shared_out, 2e-2);
  }
}

TEST(GatherLayers, AreTheSameForAnyNumberOfThreads) {
  const auto room = lay_out(lit_room(), 32);
  const light::LightLayers layers = layers_of(*room);
  const GatherParams params = with_samples(256, 8);
  const Gather many = solve(*room, params, {}, &layers);
  const ThreadLimit one(1);
  EXPECT_EQ(solve(*room, params, {}, &layers).layers, many.layers);
}

}  // namespace
}  // namespace luxel::gather
