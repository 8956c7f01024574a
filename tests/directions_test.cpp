// --directional and --probes as a user gives them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/base/spherical_harmonics.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// A floor of 4 x 4 m that faces up, on a box that is closed below it.
const char* kFloor = R"(o floor
v -2 0 -2
v -2 0 2
v 2 0 2
v 2 0 -2
v -2 -2 -2
v -2 -2 2
v 2 -2 2
v 2 -2 -2
f 1 2 3 4
f 8 7 6 5
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
)";

// Under one sun E(m) = E_s m . s: V is the sun's direction times E_s, in all three files; w is
// that over the cosine.
TEST(Directional, PointsToTheSun) {
  const ScratchFolder s;
  const auto scene = s.write("floor.obj", kFloor);
  const std::string bake = "bake " + scene.string() +
                           " --sun 90,60,100 --background 0,0,0 --resolution 64 --samples 16 "
                           "--bounces 0 --quiet --directional ";
  ASSERT_EQ(luxel(bake + "sh1 -o " + (s.path / "sh1").string()).code, 0);
  ASSERT_EQ(luxel(bake + "dominant -o " + (s.path / "dominant").string()).code, 0);
  const image::Image e = exr_at(s.path / "sh1/lightmap.exr");
  const std::array<image::Image, 3> v{exr_at(s.path / "sh1/lightmap.x.exr"),
                                      exr_at(s.path / "sh1/lightmap.y.exr"),
                                      exr_at(s.path / "sh1/lightmap.z.exr")};
  const image::Image w = exr_at(s.path / "dominant/lightmap.direction.exr");
  // --sun 90,60: towards +X, 60 degrees up.
  const Vec3 sun{0.5f, std::sqrt(0.75f), 0};
  size_t lit = 0;
  for (int y = 0; y < e.height; ++y)
    for (int x = 0; x < e.width; ++x) {
      // The top: light from above alone brings so much.
      if (e.at(x, y)[3] != 1 || std::abs(e.rgb(x, y).x - 100 * sun.y) > 0.5f) continue;
      ++lit;
      // The sun's disc of half a degree, sampled 16 times: its middle is known to 1e-3.
      EXPECT_NEAR(v[0].rgb(x, y).x, 100 * sun.x, 0.4f);
      EXPECT_NEAR(v[1].rgb(x, y).y, 100 * sun.y, 0.4f);
      EXPECT_NEAR(v[2].rgb(x, y).z, 0, 0.4f);
      EXPECT_NEAR(w.rgb(x, y).x, sun.x / sun.y, 5e-3f);
      EXPECT_NEAR(w.rgb(x, y).y, 1, 5e-3f);
    }
  EXPECT_GT(lit, 100u);
}

// Three layers 1.9 m apart over the box and a chip that floats 3 m above it: the lowest one lies in
// the box, at y = -1.4, the others stand in the air.
TEST(Probes, StandOutsideSolids) {
  const ScratchFolder s;
  const auto scene = s.write(
      "floor.obj", std::string(kFloor) + "o chip\nv 0 3 0\nv 0 3 0.01\nv 0.01 3 0\nf 9 10 11\n");
  const CommandResult r =
      luxel("bake " + scene.string() +
            " --background 1,2,3 --resolution 64 --samples 64 --probes 1.9 -o " +
            (s.path / "baked").string() + " --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const auto json = nlohmann::json::parse(slurp(s.path / "baked/probes.json"));
  EXPECT_EQ(json["count"], nlohmann::json({3, 3, 3}));
  const auto bake = nlohmann::json::parse(r.out);
  EXPECT_EQ(bake["probes"]["placed"], 18);
  EXPECT_EQ(bake["probes"]["inside_solids"], 9);
  const image::Image rows = exr_at(s.path / "baked/probes.exr");
  ASSERT_EQ(rows.width, 9);
  ASSERT_EQ(rows.height, 18);
  for (size_t point = 0; point < 27; ++point) {
    const int row = json["row"][point];
    ASSERT_EQ(row < 0, point / 3 % 3 == 0) << point;
    if (row < 0) continue;
    EXPECT_GT(json["position"][size_t(row)][1].get<double>(), 0);
    std::array<Rgb, kSh2> c;
    for (size_t k = 0; k < kSh2; ++k) c[k] = rows.rgb(int(k), row);
    // Half a sky at least, seen from above the floor: E up is pi L, to 1,024 rays and the chip.
    EXPECT_NEAR(sh2_value(c, {0, 1, 0}).y, 2 * kPi, 0.15f);
    EXPECT_NEAR(sh2_value(c, {0, 1, 0}).z / sh2_value(c, {0, 1, 0}).x, 3, 0.05f);
  }
}

TEST(Probes, HoldTheLightOfARoom) {
  const ScratchFolder s;
  const CommandResult r =
      luxel("bake " + scene_file("furnace-box.glb") +
            " --resolution 64 --samples 64 --probes 0.3 -o " + (s.path / "baked").string());
  ASSERT_EQ(r.code, 0) << r.err;
  const image::Image rows = exr_at(s.path / "baked/probes.exr");
  const image::Image light = exr_at(s.path / "baked/lightmap.exr");
  double sum = 0, count = 0;
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x)
      if (light.at(x, y)[3] == 1) sum += double(light.rgb(x, y).x), ++count;
  ASSERT_GT(rows.height, 20);
  for (int i = 0; i < rows.height; ++i) {
    std::array<Rgb, kSh2> c;
    for (size_t k = 0; k < kSh2; ++k) c[k] = rows.rgb(int(k), i);
    // A furnace brings the same from everywhere; 1,024 rays and 16 shadow rays shared by 12 lamps.
    for (uint32_t k = 0; k < 6; ++k)
      EXPECT_NEAR(double(sh2_value(c, spiral_direction(k, 6)).x) / (sum / count), 1, 0.03);
  }
}

TEST(Probes, WrongSpacingsAreRefused) {
  const ScratchFolder s;
  const auto refused = [&](const std::string& options, const std::string& words) {
    const auto output = s.path / "baked";
    const CommandResult r =
        luxel("bake " + scene_file("cornell-box.glb") + " --resolution 32 --samples 4 " + options +
              " -o " + output.string());
    EXPECT_EQ(r.code, 1) << options << r.err;
    EXPECT_THAT(r.err, HasSubstr(words)) << options;
    EXPECT_FALSE(std::filesystem::exists(output)) << options;
  };
  refused("--probes -1", "--probes -1");
  refused("--probes 0.001", "more than");
  refused("--directional up", "dominant, sh1");
}

/// Mean absolute difference of two pictures of one size.
double difference_directions(const image::Image& a, const image::Image& b) {
  EXPECT_EQ(a.width, b.width);
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const Rgb d = a.rgb(x, y) - b.rgb(x, y);
      sum += double(std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
    }
  return sum;
}

// A normal map stands for a relief, whose picture is known: a flat floor with directions comes much
// nearer to it than without, half as far and less. What is left are the bumps' outlines, shadows
// and light among themselves, the noise of all bakes, and, for dominant, lamps of two colours that
// it mixes. A map that is read the wrong way round is farther off than none.
TEST(Directional, NormalMapsLookLikeTheRelief) {
  const ScratchFolder s;
  const auto picture = [&](const std::string& scene, const std::string& name,
                           const std::string& options) {
    const std::string file = scene_file(scene), folder = (s.path / name).string();
    EXPECT_EQ(luxel("bake " + file + " -o " + folder + " --resolution 192 --quiet " + options).code,
              0);
    const std::filesystem::path drawn = s.path / (name + ".exr");
    EXPECT_EQ(luxel("render " + file + " --from " + folder + " -o " + drawn.string() +
                    " --size 160x120 --quiet")
                  .code,
              0);
    return exr_at(drawn);
  };
  const image::Image relief = picture("bumps-in-relief.glb", "relief", "--samples 128");
  const double flat = difference_directions(picture("bumps.glb", "flat", "--samples 128"), relief);
  const double sh1 =
      difference_directions(picture("bumps.glb", "sh1", "--samples 128 --directional sh1"), relief);
  const double dominant = difference_directions(
      picture("bumps.glb", "dominant", "--samples 128 --directional dominant"), relief);
  EXPECT_LT(sh1, 0.5 * flat);
  EXPECT_LT(dominant, 0.75 * flat);
  EXPECT_LT(sh1, dominant);
}

}  // namespace
}  // namespace luxel::testing_support
