// `luxel bake --solver matrix` from outside: what it leaves, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

CommandResult bake_for_matrix(const std::filesystem::path& output, const std::string& options) {
  return luxel("bake " + scene_file("spheres-and-cube.glb") +
               " --solver matrix --resolution 64 -o " + output.string() + " " + options);
}

TEST(MatrixBake, SaysWhatItUsed) {
  const ScratchFolder s;
  const CommandResult r = bake_for_matrix(s.path / "b", "--patches 500 --rays 256 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path / "b"), kBakeFiles);
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["settings"]["matrix"]["patches"], 500);
  EXPECT_EQ(json["settings"]["matrix"]["rays"], 256);
  EXPECT_NEAR(double(json["counts"]["elements"]), 500, 75);  // within 15 %, docs/method/matrix.md
  EXPECT_GT(double(json["relative_error"]), 0);
  for (const char* stage : {"patches", "form factors", "direct light", "bounces", "transfer"})
    EXPECT_TRUE(json["seconds"].contains(stage)) << stage;
}

TEST(MatrixBake, GivesTheSameBitsWithAnyNumberOfThreads) {
  const ScratchFolder s;
  ASSERT_EQ(bake_for_matrix(s.path / "1", "--patches 500 --rays 256 --threads 1").code, 0);
  ASSERT_EQ(bake_for_matrix(s.path / "2", "--patches 500 --rays 256 --threads 2").code, 0);
  EXPECT_EQ(slurp(s.path / "1" / "lightmap.exr"), slurp(s.path / "2" / "lightmap.exr"));
}

TEST(MatrixBake, RefusesWhatCannotWork) {
  const ScratchFolder s;
  for (const auto& [options, sentence] :
       {std::pair{"--patches 0", "--patches 0 is outside 1 to"},
        std::pair{"--patches 2000000", "--patches 2000000 is outside 1 to"},
        std::pair{"--rays 0", "--rays 0 is outside 1 to"},
        std::pair{"--samples 16", "does not use --samples"},
        std::pair{"--elements vertex", "does not use --elements"},
        std::pair{"--vertex-colors", "(it is for hemicube)"},
        std::pair{"--patches 1000000 --max-memory 1G", "too small for this scene"}}) {
    const CommandResult r = bake_for_matrix(s.path / "b", options);
    EXPECT_EQ(r.code, std::string(options).find("memory") != std::string::npos ? 3 : 1)
        << options << r.err;
    EXPECT_THAT(r.err, HasSubstr(sentence)) << options;
    EXPECT_FALSE(std::filesystem::exists(s.path / "b")) << options;
  }
}

}  // namespace
}  // namespace luxel::testing_support
