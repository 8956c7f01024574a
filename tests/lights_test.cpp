// Light that the command line brings: --ies and --sky, through the whole program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "luxel/base/vec_double.h"
#include "tests/black_room.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kWall = scene_file("ies/wall.gltf");

struct Lightmap {
  image::Image map;
  double mean_luminance() const {
    double sum = 0, count = 0;
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        if (map.at(x, y)[3] == 1) sum += double(luminance(map.rgb(x, y))), ++count;
    return sum / count;
  }
};

Lightmap bake(const std::string& scene, const std::string& options, std::string* err = nullptr) {
  const ScratchFolder s;
  const CommandResult r =
      luxel("bake " + scene + " -o " + (s.path / "b").string() + " --resolution 64 " + options);
  EXPECT_EQ(r.code, 0) << options << ": " << r.err;
  if (err) *err = r.err;
  return {lightmap_of(s.path / "b")};
}

const std::string kProfiles = "--ies left=" + scene_file("ies/spot.ies") +
                              " --ies middle=" + scene_file("ies/batwing.ies") +
                              " --ies right=" + scene_file("ies/wall-washer.ies") + " ";

// Means of gather and matrix radiosity against the path tracer's, on the same map. Its 1024 samples
// pick one of three lamps: about 1.5 / sqrt(1024) = 4.7 % per texel, and
// 0.1 % in the mean of some 2,000 texels; gather's own noise is of indirect light alone.
TEST(Profiles, SolversAgreeWithThePathTracer) {
  const Lightmap paths = bake(kWall, kProfiles + "--solver reference --samples 1024");
  const double mean = paths.mean_luminance();
  EXPECT_NEAR(bake(kWall, kProfiles + "--samples 256").mean_luminance(), mean, 0.005 * mean);
  EXPECT_NEAR(bake(kWall, kProfiles + "--solver matrix --patches 1000").mean_luminance(), mean,
              0.02 * mean);
}

TEST(Profiles, TheScaleScales) {
  const std::string file = scene_file("ies/spot.ies");
  const std::string others = " --samples 16 --ies middle=" + file + ",0 --ies right=" + file + ",0";
  const double one = bake(kWall, "--ies left=" + file + others).mean_luminance();
  const double three = bake(kWall, "--ies left=" + file + ",3" + others).mean_luminance();
  EXPECT_NEAR(three, 3 * one, 1e-4 * three);
}

TEST(Profiles, AreInBakeJson) {
  const ScratchFolder s;
  const CommandResult r = luxel(
      "bake " + kWall + " -o " + (s.path / "b").string() +
      " --resolution 32 --samples 4 --json --ies left=" + scene_file("ies/spot.ies") + ",0.5");
  ASSERT_EQ(r.code, 0) << r.err;
  const auto ies = nlohmann::json::parse(r.out)["settings"]["ies"];
  ASSERT_EQ(ies.size(), 1u);
  EXPECT_EQ(ies[0]["lamp"], "left");
  EXPECT_EQ(ies[0]["scale"], 0.5);
}

TEST(Profiles, WhatCannotBeIsSaid) {
  const ScratchFolder s;
  const std::string out = " -o " + (s.path / "x").string();
  const CommandResult unknown =
      luxel("bake " + kWall + out + " --ies lamp=" + scene_file("ies/spot.ies"));
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("choose from: 'left', 'middle', 'right'"));
  const CommandResult broken = luxel("bake " + kWall + out + " --ies left=" + kWall);
  EXPECT_EQ(broken.code, 1);
  EXPECT_THAT(broken.err, AllOf(HasSubstr("wall.gltf"), HasSubstr("TILT=")));
  const CommandResult kept =
      luxel("relight " + kWall + out + ".lxr --ies left=" + scene_file("ies/spot.ies"));
  EXPECT_EQ(kept.code, 1);
  EXPECT_THAT(kept.err, HasSubstr(".lxr files do not keep light profiles"));
  EXPECT_TRUE(files_in(s.path).empty());
}

// All light of a lamp in the middle of a black room's ceiling falls on floor and walls: 2 pi I over
// 2 (4 * 3 + 4 * 3 + 4 * 4) m^2. Texels on the walls beside the ceiling are lit unevenly. One bake
// takes a third of a second.
TEST(Lamps, InTheCeilingShineForEverySolver) {
  const ScratchFolder s;
  const auto scene = s.write("flush.gltf", room_gltf({-2, 0, -2}, {2, 3, 2}, 0, {0, 3, 0}, 900));
  const double mean = 2 * kPiDouble * 900 / 80;
  for (const char* solver :
       {"gather --samples 4", "reference --samples 16", "hemicube --max-elements 500",
        "matrix --patches 200", "hierarchical"}) {
    std::string err;
    const Lightmap map = bake(scene.string(), std::string("--solver ") + solver, &err);
    EXPECT_NEAR(map.mean_luminance(), mean, 0.01 * mean) << solver;
    EXPECT_THAT(err, Not(HasSubstr("lights nothing"))) << solver;
  }
}

TEST(Lamps, BehindTheCeilingAreNamed) {
  const ScratchFolder s;
  const auto scene =
      s.write("above.gltf", room_gltf({-2, 0, -2}, {2, 3, 2}, 0, {0, 3.005f, 0}, 900));
  std::string err;
  EXPECT_EQ(bake(scene.string(), "", &err).mean_luminance(), 0);
  EXPECT_THAT(err, HasSubstr("light 'lamp' lights nothing: it lies 5"));
  EXPECT_THAT(err, HasSubstr(" mm behind the front of 'room' (instance 0)"));
}

// A plate under an open sky gets what the sky and its sun bring to the horizontal; at 50 degrees
// [IES84] says 127.5 exp(-0.21 / sin h) sin h + 0.8 + 15.5 sqrt(sin h) = 88.7 klx. Within a tenth,
// see luxel/scene/sky_test.cpp.
TEST(SkyOption, APlateIsAsBrightAsDay) {
  const ScratchFolder s;
  const auto plate = s.write("plate.obj", "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n");
  const double lux = bake(plate.string(), "--samples 64 --sky 120,50").mean_luminance();
  EXPECT_NEAR(lux, 88.7e3, 8.9e3);
  const double by_time =
      bake(plate.string(), "--samples 64 --sky 2026-06-21T15:30+02:00,48.85,2.35").mean_luminance();
  EXPECT_GT(by_time, lux);  // the sun stands at 59 degrees
  EXPECT_LT(by_time, 1.2 * lux);
}

TEST(SkyOption, GoesWithoutAnotherSun) {
  const ScratchFolder s;
  const std::string out = " -o " + (s.path / "x").string();
  EXPECT_EQ(luxel("bake " + kWall + out + " --sky 120,50 --sun 1,2,3").code, 2);
  EXPECT_EQ(luxel("bake " + kWall + out + " --sky 120,50 --background 1,1,1").code, 2);
  const CommandResult bad = luxel("bake " + kWall + out + " --sky 2026-06-21T15:30,48,2");
  EXPECT_EQ(bad.code, 1);
  EXPECT_THAT(bad.err, HasSubstr("offset from UTC"));
}

}  // namespace
}  // namespace luxel::testing_support
