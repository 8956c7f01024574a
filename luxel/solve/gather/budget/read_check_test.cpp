// The error of texels: light that rays read in the map, held against the places that they meet.
#include "luxel/solve/gather/budget/read_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/gather/budget/expected_rms.h"
#include "luxel/solve/gather/budget/texel_error.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/rays/traced_hits.h"
#include "luxel/transport/texel_width.h"

namespace luxel::gather {
namespace {

/// By which part of itself the light of `irradiance` is too bright where rays read it, by so many
/// rays.
ReadError error_of(const Room& room, std::span<const Rgb> irradiance, uint64_t rays,
                   bool follows_near = true) {
  Progress progress;
  const transport::OwnSides sides =
      transport::find_own_sides(room.scene, room.atlas, room.map, *room.tracer);
  TracedHits hits = no_hits(room.elements.size());
  std::fill(hits.samples.begin(), hits.samples.end(), uint16_t(1));
  const auto check = make_read_check(scene_of(room), sides, hits,
                                     {.rays = rays, .follows_near = follows_near}, progress);
  EXPECT_TRUE(check) << check.error().message;
  EXPECT_GT(check->size(), 10000u);
  const auto error = read_error(*check, {room.map, room.elements, hits, {}, irradiance}, progress);
  EXPECT_TRUE(error) << error.error().message;
  return *error;
}

// In a furnace every place gets pi e / (1 - rho), of which pi e come straight from the walls. A map
// that holds a tenth more says 1.1 rho E where rho (pi e + 1.1 rho E) are sent: too much by
// 0.1 rho (1 - rho) E, a tenth of what the place sends of the walls' own light, rho pi e. Near rays
// bring what is true, and make that larger alike.
TEST(ReadCheck, TellsAMapThatIsTooBrightByATenth) {
  const float rho = 0.5f;
  const auto room = lay_out(scene::furnace_box({rho, rho, rho}, {1, 1, 1}), 32);
  const float e = kPi / (1 - rho);
  for (const float factor : {1.0f, 1.1f, 0.9f}) {
    const std::vector<Rgb> light(room->elements.size(), Rgb{e, e, e} * factor);
    const ReadError error = error_of(*room, light, 1 << 18);
    // Four of its own standard errors; and near rays start from places that are known to 0.1 %.
    EXPECT_NEAR(error.part, double(factor) - 1, 4 * error.standard_error + 2e-3) << factor;
    EXPECT_LT(error.standard_error, 5e-3);
  }
}

/// The share of a place's cosine-weighted rays that leave a box through its floor, less the share
/// through its ceiling.
double floor_less_ceiling(const Box3& box, Vec3 from, Vec3 normal) {
  constexpr uint32_t kRays = 256;
  const Frame frame = frame_around(normal);
  double sum = 0;
  for (uint32_t k = 0; k < kRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 99)));
    const auto way = [](float x, float along, float low, float high) {
      return along > 0 ? (high - x) / along : along < 0 ? (low - x) / along : INFINITY;
    };
    const float up = way(from.y, d.y, box.lower.y, box.upper.y);
    const float side = std::min(way(from.x, d.x, box.lower.x, box.upper.x),
                                way(from.z, d.z, box.lower.z, box.upper.z));
    if (up < side) sum += d.y < 0 ? 1 : -1;
  }
  return sum / kRays;
}

// A map says a fifth too much of a furnace's floor, and a fifth too little of its ceiling. It is
// right in the mean; but the ceiling reads a fifth of what it sees of the floor too much, the floor
// as much too little, and walls read either by their height. With rho = 0.1 what places get of this
// in turn is a tenth of that.
TEST(ReadCheck, TellsWhatTexelsReadApart) {
  constexpr float kRho = 0.1f, kOff = 0.2f, kE = kPi / (1 - kRho);
  const auto room = lay_out(scene::furnace_box({kRho, kRho, kRho}, {1, 1, 1}), 32);
  const Box3 box = scene::world_bounds(room->scene);
  const auto is_floor = [&](size_t i) { return room->elements.geometric_normal[i].y > 0.5f; };
  std::vector<Rgb> light;
  double apart = 0, read = 0, of_floor = 0, floor = 0;
  uint32_t chart = 0;
  for (size_t i = 0; i < room->elements.size(); ++i) {
    const Vec3 n = room->elements.geometric_normal[i];
    light.push_back(Rgb{1, 1, 1} * (kE * (1 + kOff * std::round(n.y))));
    const double off = double(kOff) * floor_less_ceiling(box, room->elements.position[i], n);
    apart += off * off, read += (1 + off) * (1 + off);
    if (!is_floor(i)) continue;
    of_floor += off * off, floor += 1;
    chart = room->atlas.chart[room->map.texels[i].triangle_number];
  }
  const ReadError error = error_of(*room, light, 1 << 19, false);
  EXPECT_NEAR(error.part, 0, 0.01);
  EXPECT_NEAR(std::sqrt(error.square_apart), std::sqrt(apart / read),
              0.1 * std::sqrt(apart / read));
  // Over the floor's own light, which is said to be 1.2 E, of which it gathers rho.
  const double relative = double(kRho) / (1 + double(kOff)) * std::sqrt(of_floor / floor);
  ASSERT_LT(chart, error.relative_square_apart.size());
  EXPECT_NEAR(std::sqrt(double(error.relative_square_apart[chart])), relative, 0.2 * relative);
  // A map that is right has nothing of it but what is left of noise.
  const std::vector<Rgb> right(light.size(), Rgb{kE, kE, kE});
  EXPECT_LT(error_of(*room, right, 1 << 19, false).square_apart, 1e-2 * apart / read);
}

// A lamp stands 20 cm above the middle of a floor of 4 x 4 m, whose texels are half a metre wide
// and do not know the spot below it. The floor gets the lamp's intensity times the square's solid
// angle, and rays read what its texels hold. A ceiling 10 m higher sees all of the floor alike, and
// sends next to nothing back; one of its rays in twenty meets the floor.
TEST(ReadCheck, FindsASpotThatTexelsMiss) {
  constexpr float kLamp = 0.2f, kCeiling = 10;
  scene::Scene s;
  const uint32_t white = scene::add_material(s, "white", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(s, {-2, 2, -2, 2}, 0, true, white);
  scene::add_rectangle(s, {-2, 2, -2, 2}, kCeiling, false, white);
  scene::PunctualLight lamp;
  lamp.position = {0, kLamp, 0}, lamp.intensity = {1, 1, 1};
  s.lights.push_back(lamp);
  const auto room = lay_out(std::move(s), 16);
  const Gather light = solve(*room, with_samples(256));
  // The rectangle's solid angle from above its middle.
  const auto solid_angle = [](double height) {
    const double a = 2 / height;
    return 4 * std::asin(a * a / (1 + a * a));
  };
  double read = 0;
  for (size_t i = 0; i < room->elements.size(); ++i) {
    const scene::SurfacePoint& p = room->map.texels[i].sample;
    const double width_m =
        double(transport::texel_width_m(room->scene, room->atlas, p.instance, p.triangle));
    if (room->elements.position[i].y < 1) read += double(light.direct[i].x) * width_m * width_m;
  }
  const double floor = solid_angle(kLamp), ceiling = solid_angle(kCeiling - kLamp);
  ASSERT_GT(std::abs(read - floor), 0.1 * floor) << "the texels know the spot";
  const ReadError error = error_of(*room, light.irradiance, 1 << 22);
  // Texels at the border may lie half outside of the floor, where a fiftieth of its light is.
  EXPECT_NEAR(error.part, (read - floor) / (floor + ceiling), 4 * error.standard_error + 0.02);
  EXPECT_LT(4 * error.standard_error, 0.1);
}

// Two normal densities' product. Where nothing is measured, what neighbours say is left, or half of
// it as the likely value; where it is exact, it alone counts; where both are as sure, half of the
// measured part and half of the variance: sqrt(0.02^2 + 0.04^2 / 2).
TEST(TexelErrorOfBoth, IsTheSurerOne) {
  EXPECT_DOUBLE_EQ(texel_error({0.04}, {}).safe, 0.04);
  EXPECT_DOUBLE_EQ(texel_error({0.04}, {}).likely, 0.02);
  EXPECT_DOUBLE_EQ(texel_error({0.04}, {-0.1, 0}).safe, 0.1);
  EXPECT_DOUBLE_EQ(texel_error({0.04}, {-0.1, 0}).likely, 0.1);
  EXPECT_NEAR(texel_error({0.04}, {-0.04, 0.04}).safe, std::sqrt(0.0004 + 0.0008), 1e-12);
  EXPECT_DOUBLE_EQ(texel_error({0}, {0, 0}).safe, 0);
}

// Two texels with light of 1 and 3: 0.71 of the noise's variance counts, and the given part of what
// texels cost. A hidden one does not.
TEST(ExpectedRms, CountsPartsOfSafeVariances) {
  TracedHits hits = no_hits(3);
  hits.samples = {10, 10, 10}, hits.met_back = {0, 0, 10};
  const std::vector<Rgb> light{{1, 1, 1}, {3, 3, 3}, {100, 100, 100}};
  const std::vector<float> noise{0.02f, 0.04f, 50}, all{0.10f, 0.12f, 90};
  const double squares = (0.06 * std::sqrt(0.5) + 0.25 * 0.16) / 2;
  EXPECT_NEAR(expected_squares(light, {noise, all, 0.25}, hits).rms(), std::sqrt(squares) / 2,
              1e-6);
}

}  // namespace
}  // namespace luxel::gather
