// Parts of light, shadow masks and ambient occlusion through the whole program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

CommandResult bake_parts(const std::string& scene, const std::string& options,
                         const std::filesystem::path& folder) {
  return luxel("bake " + scene_file(scene) + " -o " + folder.string() +
               " --resolution 64 --samples 4 " + options);
}

// The files hold the same, in 8 bits and in floats, and bake.json says which channel is which.
TEST(SurfaceMaps, AreFilesOfTheBake) {
  const ScratchFolder s;
  const CommandResult r = bake_parts(
      "closed-corner.glb", "--shadow-mask sun --ambient-occlusion 0.5 --light no-punctual --json",
      s.path / "b");
  ASSERT_EQ(r.code, 0) << r.err;
  std::set<std::string> expected = kBakeFiles;
  expected.insert(
      {"shadow-mask.png", "shadow-mask.exr", "ambient-occlusion.png", "ambient-occlusion.exr"});
  EXPECT_EQ(files_in(s.path / "b"), expected);
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["files"].get<std::set<std::string>>(), expected);
  const nlohmann::json sun = {{"channel", "R"}, {"light", "sun"}, {"kind", "directional"}};
  EXPECT_EQ(json["shadow_mask"]["channels"], nlohmann::json::array({sun}));
  EXPECT_EQ(json["settings"]["light"], "no-punctual");
  EXPECT_EQ(json["settings"]["occlusion_distance_m"], 0.5);
  const image::Image mask = exr_at(s.path / "b" / "shadow-mask.exr");
  ASSERT_EQ(mask.channels, 4);
  const auto png =
      image::decode_ldr(*read_file(s.path / "b" / "shadow-mask.png"), "shadow-mask.png");
  ASSERT_TRUE(png);
  float least = 1, most = 0;
  for (size_t i = 0; i < mask.data.size(); ++i) {
    EXPECT_NEAR(png->data[i], mask.data[i] * 255, 0.51f);
    least = std::min(least, mask.data[i]), most = std::max(most, mask.data[i]);
  }
  EXPECT_EQ(least, 0);
  EXPECT_EQ(most, 1);
}

TEST(SurfaceMaps, WhatDoesNotGoTogetherIsSaid) {
  const ScratchFolder s;
  for (const auto& [options, says] :
       {std::pair{"--light indirect --layers per-light", "--layers"},
        std::pair{"--light direct --keep", "--keep"},
        std::pair{"--light indirect --solver hemicube", "gather"},
        std::pair{"--light half", "no-punctual"}, std::pair{"--shadow-mask middle,nobody", "left"},
        std::pair{"--shadow-mask a,b,c,d,e", "one to four"},
        std::pair{"--shadow-mask left,", "one to four"},
        std::pair{"--ambient-occlusion 0", "metres > 0"},
        std::pair{"--ambient-occlusion far", "metres > 0"}}) {
    const CommandResult r = bake_parts("ies/wall.gltf", options, s.path / "b");
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, HasSubstr(says)) << options;
  }
  EXPECT_EQ(files_in(s.path), std::set<std::string>{});
}

}  // namespace
}  // namespace luxel::testing_support
