// The relit map against the relighter's own answer, and its gutter against the one of bakes.
#include "luxel/view/relight/relit_light.h"

#include <gtest/gtest.h>

#include "luxel/post/dilate.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::view {
namespace {

constexpr uint32_t kMapSide = 16;
/// Every fifth texel has no patch that lights it.
constexpr uint32_t kHidden = 5;

/// The floor of the Cornell box as a patch of texels in the middle of a map.
matrix::Target floor_texels() {
  matrix::Target target;
  target.kind = matrix::Target::Kind::texels;
  target.width = target.height = kMapSide;
  for (uint16_t y = 0; y < 8; ++y)
    for (uint16_t x = 0; x < 8; ++x) {
      target.texel.push_back({uint16_t(x + 3), uint16_t(y + 5)});
      const Vec3 place{0.55f * (float(x) + 0.5f) / 8, 0, 0.55f * (float(y) + 0.5f) / 8};
      target.position.push_back(scene::off_surface(place, {0, 1, 0}, 1));
      target.normal.push_back({0, 1, 0});
    }
  target.geometric_normal = target.normal;
  return target;
}

matrix::RelightData box_data() {
  const scene::Scene scene = scene::cornell_box();
  const trace::RayTracer tracer = *trace::RayTracer::build(scene);
  matrix::RelightParams params;
  params.patches.count = 200, params.factors.rays_per_patch = 128;
  params.codec = matrix::CodecKind::dense32;
  Progress progress;
  auto data = matrix::make_relight_data(scene, tracer, floor_texels(), params, progress);
  EXPECT_TRUE(data) << data.error().message;
  return std::move(*data);
}

Lamp point_at(Vec3 position) {
  Lamp lamp;
  lamp.light.position = position;
  return lamp;
}

// The map holds the relighter's E at each texel, for lamps moved, dimmed, coloured and off.
TEST(RelitLight, IsTheRelightersAnswerOnAMap) {
  const matrix::RelightData data = box_data();
  auto made = matrix::Relighter::make(data, {});
  ASSERT_TRUE(made);
  auto light = make_relit_light(data);
  ASSERT_TRUE(light);
  Lamps lamps = lamps_of(data);
  ASSERT_TRUE(lamps.lamps.empty());
  lamps.lamps = {point_at({0.1f, 0.4f, 0.1f}), point_at({0.4f, 0.1f, 0.4f})};
  lamps.lamps[1].is_on = false;
  std::vector<Rgb> radiance;
  for (const Glow& glow : lamps.glows) radiance.push_back(glow.radiance);
  for (int step = 0; step < 3; ++step) {
    if (step == 1) lamps.lamps[0].light.position = {0.45f, 0.2f, 0.3f};
    if (step == 2) {
      lamps.lamps[0].light.intensity = {0.1f, 0, 2};
      for (Glow& glow : lamps.glows) glow.is_on = false;
      radiance.assign(radiance.size(), {});
    }
    relight(lamps, *light);
    made->update({{&lamps.lamps[0].light, 1}, radiance});
    const std::vector<Rgb>& want = made->latest().indirect_at_points;
    const std::vector<std::array<uint16_t, 2>>& texel = data.target.texel;
    size_t lit = 0;  // the others lie under the blocks
    for (size_t k = 0; k < want.size(); ++k) {
      if (luminance(want[k]) <= 0) continue;
      ++lit;
      EXPECT_EQ(light->indirect.rgb(texel[k][0], texel[k][1]), want[k]) << step << " " << k;
    }
    EXPECT_GT(lit, 40u) << step;
  }
}

TEST(RelitLight, LampsBeginAsTheyWereBaked) {
  matrix::RelightData data = box_data();
  data.lights = {point_at({1, 2, 3}).light};
  data.background = {1, 2, 4};
  const Lamps lamps = lamps_of(data);
  EXPECT_EQ(lamps.background, data.background);
  ASSERT_EQ(lamps.lamps.size(), 1u);
  EXPECT_EQ(lamps.lamps[0].light.position, (Vec3{1, 2, 3}));
  // The box's lamp is even: its mean is what its material says.
  const scene::Scene scene = scene::cornell_box();
  ASSERT_EQ(lamps.glows.size(), scene.materials.size());
  for (size_t m = 0; m < lamps.glows.size(); ++m) {
    const Rgb off = lamps.glows[m].radiance - scene.materials[m].emission;
    EXPECT_LE(length(off), 1e-4f * length(scene.materials[m].emission)) << lamps.glows[m].name;
    EXPECT_EQ(lamps.glows[m].name, scene.materials[m].name);
  }
}

// Texels that no patch lights get their neighbours' light, as the gutter does.
TEST(RelitMap, GutterIsThatOfBakes) {
  matrix::Target target = floor_texels();
  std::vector<Rgb> light;
  for (uint32_t k = 0; k < target.texel.size(); ++k) {
    light.push_back({float(k), float(k % 7), 1});
    target.transfer.first.push_back(uint32_t(target.transfer.patch.size()));
    if (k % kHidden != 0) target.transfer.patch.push_back(0);
  }
  target.transfer.first.push_back(uint32_t(target.transfer.patch.size()));
  image::Image map(kMapSide, kMapSide, 4), want(kMapSide, kMapSide, 4);
  put_light(map_places(target), light, map);
  for (uint32_t k = 0; k < light.size(); ++k) {
    if (k % kHidden == 0) continue;
    want.set_rgb(target.texel[k][0], target.texel[k][1], light[k]);
    want.at(target.texel[k][0], target.texel[k][1])[3] = 1;
  }
  post::dilate(want, 2);
  for (int y = 0; y < int(kMapSide); ++y)
    for (int x = 0; x < int(kMapSide); ++x)
      EXPECT_EQ(map.rgb(x, y), want.rgb(x, y)) << x << " " << y;
}

}  // namespace
}  // namespace luxel::view
