// --environment as a user gives it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/image/codec.h"
#include "tests/command.h"
#include "tests/pictures.h"
#include "tests/support.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

std::string hdr_text(int width, int height, Rgb color) {
  image::Image picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture.set_rgb(x, y, color);
  const std::vector<std::byte> bytes = image::encode_hdr(picture);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A map of one radiance gives what --background gives.
TEST(EnvironmentMap, OfOneColourIsABackground) {
  const ScratchFolder s;
  const auto map = s.write("sky.hdr", hdr_text(16, 8, {0.5f, 0.25f, 1}));
  const std::string scene = scene_file("spheres-and-cube.glb");
  const std::string options = " --resolution 64 --samples 64 --quiet -o ";
  ASSERT_EQ(luxel("bake " + scene + " --environment " + map.string() + options +
                  (s.path / "map").string())
                .code,
            0);
  ASSERT_EQ(
      luxel("bake " + scene + " --background 0.5,0.25,1" + options + (s.path / "plain").string())
          .code,
      0);
  const CommandResult r = luxel("compare " + (s.path / "map/lightmap.exr").string() + " " +
                                (s.path / "plain/lightmap.exr").string() + " --json");
  ASSERT_EQ(r.code, 0) << r.err;
  // Equal rays see equal radiance; sums differ by rounding, seams are stitched to 1e-5.
  EXPECT_LE(nlohmann::json::parse(r.out)["relative_rmse"].get<double>(), 1e-4);
}

// Turned by 90 degrees as a compass turns, scaled by 2: north becomes east.
TEST(EnvironmentMap, IsTurnedAndScaled) {
  const ScratchFolder s;
  image::Image north(32, 16, 3);
  for (int y = 0; y < 16; ++y)
    for (int x = 4; x < 12; ++x) north.set_rgb(x, y, {1, 1, 1});  // a quarter, around -Z
  const std::vector<std::byte> bytes = image::encode_hdr(north);
  const auto map = s.write("a,b.hdr", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const std::string render = "render " + scene_file("cornell-box-empty.glb") +
                             " --technique path --samples 1 --size 4x4 --eye 50,50,50 --quiet ";
  const auto seen = [&](const std::string& options, const std::string& towards) {
    const auto file = s.path / "picture.exr";
    const CommandResult r = luxel(render + "--look-at " + towards + " --fov-deg 5 --environment '" +
                                  map.string() + options + "' -o " + file.string());
    EXPECT_EQ(r.code, 0) << r.err;
    const image::Image picture = exr_at(file);
    return picture.width > 2 ? picture.rgb(2, 2).x : -1.0f;
  };
  EXPECT_NEAR(seen("", "50,50,40"), 1, 1e-3f);
  EXPECT_NEAR(seen("", "60,50,50"), 0, 1e-3f);
  EXPECT_NEAR(seen(",90,2", "60,50,50"), 2, 1e-3f);
  EXPECT_NEAR(seen(",90", "50,50,40"), 0, 1e-3f);
}

TEST(EnvironmentMap, WrongOnesAreRefused) {
  const ScratchFolder s;
  const auto refused = [&](const std::string& map, const std::string& words) {
    const auto output = s.path / "baked";
    const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") + " --environment '" +
                                  map + "' -o " + output.string());
    EXPECT_EQ(r.code, 1) << map << r.err;
    EXPECT_THAT(r.err, HasSubstr(words)) << map;
    EXPECT_FALSE(std::filesystem::exists(output)) << map;
  };
  const std::string good = hdr_text(16, 8, {1, 1, 1});
  refused((s.path / "none.hdr").string(), "none.hdr");
  refused(s.write("square.hdr", hdr_text(8, 8, {1, 1, 1})).string(), "8 x 8");
  refused(s.write("sky.png", "x").string(), ".hdr or .exr");
  refused(s.write("cut.hdr", good.substr(0, good.size() / 2)).string(), "cut.hdr");
  refused(s.write("sky.hdr", good).string() + ",10,-1", "scale");
  refused(",90", "FILE");
}

}  // namespace
}  // namespace luxel::testing_support
