// `luxel bake` to an error, in a time, and what it says beforehand; from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string box(const ScratchFolder& s, const std::string& options) {
  return "bake " + scene_file("cornell-box.glb") + " --resolution 32 -o " +
         (s.path / "out").string() + " " + options;
}
nlohmann::json json_of(const ScratchFolder& s) {
  return nlohmann::json::parse(slurp(s.path / "out" / "bake.json"));
}

TEST(MaxError, IsReachedAndReported) {
  const ScratchFolder s;
  const CommandResult r = luxel(box(s, "--max-error 0.1 --error-map"));
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json error = json_of(s)["error"];
  EXPECT_EQ(error["asked"], 0.1);
  EXPECT_LE(error["relative_p95"], 0.1);
  EXPECT_GE(error["worst"]["relative"], error["relative_p95"]);
  // The box is a cube of 0.55 m; whatever is worst lies in it.
  for (const nlohmann::json& x : error["worst"]["position"]) EXPECT_LE(std::abs(double(x)), 1);
  EXPECT_FALSE(error["worst"]["node"].get<std::string>().empty());
  EXPECT_EQ(error["samples"]["fewest"], 32);
  EXPECT_GE(error["samples"]["most"], error["samples"]["mean"]);
  EXPECT_THAT(r.err, Not(HasSubstr("warning")));
  EXPECT_TRUE(files_in(s.path / "out").contains("error.png"));
}

TEST(MaxError, WinsOverSamplesAndSaysSo) {
  const ScratchFolder s;
  const CommandResult r = luxel(box(s, "--max-error 0.2 --samples 4"));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("--max-error 0.2 sets the number of rays"));
  EXPECT_THAT(r.err, HasSubstr("--samples 4 is ignored"));
  EXPECT_GE(json_of(s)["error"]["samples"]["fewest"], 32);
}

// No texel gets more than 16,384 rays: a hundredth of a percent is not for sale.
TEST(SlowMaxErrorCommand, SaysWhenItIsNotReached) {
  const ScratchFolder s;
  const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") +
                                " --resolution 16 --max-error 0.0001 -o " + s.path.string());
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("--max-error 0.0001 was not reached"));
}

// Without an error asked for, it is known all the same.
TEST(MaxError, IsKnownOfEveryBake) {
  const ScratchFolder s;
  ASSERT_EQ(luxel(box(s, "--samples 16 --quiet")).code, 0);
  const nlohmann::json coarse = json_of(s)["error"];
  ASSERT_EQ(luxel(box(s, "--samples 1024 --quiet")).code, 0);
  const nlohmann::json fine = json_of(s)["error"];
  EXPECT_FALSE(fine.contains("asked"));
  // 64 times the rays: an eighth of the error if they were independent, less because they are not;
  // direct light, which has as many shadow rays in both, is a part of it.
  EXPECT_LT(fine["relative_p95"], 0.5 * double(coarse["relative_p95"]));
}

TEST(MaxError, BadNumbersAreRefused) {
  const ScratchFolder s;
  for (const auto& [options, says] :
       {std::pair("--max-error 0", "would never end"),
        {"--max-error -1", "--max-error -1"},
        {"--max-error 1e-9", "--max-error 1e-09 is outside 0.0001 to 1"},
        {"--max-error nan", "--max-error"},
        {"--time-budget 0", "--time-budget 0"},
        {"--time-budget -3", "--time-budget -3"},
        {"--time-budget inf", "--time-budget inf"},
        {"--solver reference --error-map", "--solver reference does not use --error-map"},
        {"--solver matrix --plan", "--solver matrix does not use --plan"}}) {
    const CommandResult r = luxel(box(s, options));
    EXPECT_EQ(r.code, 1) << options;
    EXPECT_THAT(r.err, HasSubstr(says));
    EXPECT_FALSE(std::filesystem::exists(s.path / "out"));
  }
}

TEST(Plan, SaysWhatABakeTakesAndBakesNothing) {
  const ScratchFolder s;
  const CommandResult text = luxel(box(s, "--plan"));
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.err, HasSubstr("nothing was baked"));
  EXPECT_FALSE(std::filesystem::exists(s.path / "out"));
  const CommandResult r = luxel(box(s, "--plan --json --quiet"));
  const nlohmann::json plan = nlohmann::json::parse(r.out);
  ASSERT_EQ(luxel(box(s, "--quiet")).code, 0);
  const nlohmann::json bake = json_of(s);
  EXPECT_EQ(plan["texels"], bake["counts"]["texels"]);
  EXPECT_EQ(plan["resolution"], 32);
  // So small a scene is tried whole: what is left is which texels are averaged over.
  EXPECT_NEAR(double(plan["rays"]) / double(bake["counts"]["rays"]), 1, 0.25);
  EXPECT_GT(plan["seconds"]["total"], 0);
  EXPECT_GT(plan["memory_bytes"], 1e6);
  for (const char* count : {"rays", "memory_bytes", "scratch_bytes"})
    EXPECT_TRUE(plan[count].is_number_unsigned()) << count;
}

// Rays and memory of 180,000 texels with 256 samples: 25 %, as is promised. Seconds are judged by
// `luxel bench budget`.
TEST(SlowPlanCommand, KnowsTheRaysAndTheMemory) {
  const ScratchFolder s;
  const std::string bake = "bake " + scene_file("cornell-box.glb") + " --resolution 512 -o " +
                           s.path.string() + " --quiet --json";
  const nlohmann::json plan = nlohmann::json::parse(luxel(bake + " --plan").out);
  const nlohmann::json done = nlohmann::json::parse(luxel(bake).out);
  EXPECT_NEAR(double(plan["rays"]) / double(done["counts"]["rays"]), 1, 0.25);
  EXPECT_NEAR(double(plan["memory_bytes"]) / double(done["peak_memory_bytes"]), 1, 0.25);
}

// The plan predicts the rays to an error, too: it makes the rounds for some texels only.
TEST(SlowPlanCommand, KnowsTheRaysToAnError) {
  const ScratchFolder s;
  const std::string bake = "bake " + scene_file("cornell-box.glb") +
                           " --resolution 256 --max-error 0.03 -o " + s.path.string() +
                           " --quiet --json";
  const nlohmann::json plan = nlohmann::json::parse(luxel(bake + " --plan").out);
  const nlohmann::json done = nlohmann::json::parse(luxel(bake).out);
  EXPECT_NEAR(double(plan["rays"]) / double(done["counts"]["rays"]), 1, 0.25);
}

// An hour is far more than 16,384 rays for each of some hundred texels take.
TEST(SlowTimeBudget, EndsWhenNothingIsLeftToDo) {
  const ScratchFolder s;
  const CommandResult r = luxel("bake " + scene_file("cornell-box.glb") +
                                " --resolution 16 --time-budget 3600 -o " + s.path.string());
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json json = nlohmann::json::parse(slurp(s.path / "bake.json"));
  EXPECT_GT(json["error"]["samples"]["mean"], 8192);
}

// All that is not light counts, too.
TEST(SlowTimeBudget, HoldsWithTheDenoiser) {
  const ScratchFolder s;
  const CommandResult r =
      luxel("bake " + scene_file("cornell-box.glb") +
            " --resolution 256 --time-budget 10 --denoise -o " + s.path.string());
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json json = nlohmann::json::parse(slurp(s.path / "bake.json"));
  EXPECT_LT(json["seconds"]["total"], 15) << "beside other tests; without the denoiser counted: 26";
  EXPECT_GT(json["seconds"]["total"], 5) << "light gets what is left";
}

TEST(TimeBudget, IsForSamplesToSuit) {
  const ScratchFolder s;
  const CommandResult r = luxel(box(s, "--time-budget 0.01 --samples 4096"));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("--time-budget 0.01 sets the number of rays"));
  EXPECT_THAT(r.err, HasSubstr("--time-budget 0.01 leaves"));
  EXPECT_LT(json_of(s)["error"]["samples"]["most"], 4096);
}

// Solvers that have nothing before their end are stopped, and say what to change. An hour changes
// nothing of what they do.
TEST(TimeBudget, EndsSolversThatCannotEndEarlier) {
  for (const std::string solver : {"hemicube", "matrix", "hierarchical", "reference"}) {
    const ScratchFolder s;
    const CommandResult r = luxel(box(s, "--time-budget 0.001 --solver " + solver));
    EXPECT_EQ(r.code, 3) << solver << r.err;
    EXPECT_THAT(r.err, HasSubstr("--time-budget 0.001 ran out in the stage"));
    EXPECT_THAT(r.err, HasSubstr("before --solver " + solver + " had a result"));
    EXPECT_FALSE(std::filesystem::exists(s.path / "out"));
  }
  const ScratchFolder s;
  const CommandResult r =
      luxel(box(s, "--time-budget 3600 --solver matrix --patches 300 --rays 64"));
  EXPECT_EQ(r.code, 0) << r.err;
}

}  // namespace
}  // namespace luxel::testing_support
