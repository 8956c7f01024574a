// Bakes that several processes share out, and that are merged: docs/guide/many-machines.md.
#include <gmock/gmock.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "tests/command.h"
#include "tests/running.h"

namespace luxel::testing_support {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BakesInParts : public ::testing::Test {
 protected:
  std::string part(int number, int of, const std::string& more) const {
    return fmt::format("bake {} -o {} --part {}/{} --json", more, folder_.string(), number, of);
  }
  nlohmann::json done(int number, int of, const std::string& more) const {
    const CommandResult r = luxel(part(number, of, more));
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out)["part"];
  }
  std::string merged(const std::string& parts) {
    const fs::path folder = scratch_.path / "merged";
    fs::remove_all(folder);
    const CommandResult r = luxel("merge " + parts + " -o " + folder.string());
    EXPECT_EQ(r.code, 0) << r.err;
    const auto report = nlohmann::json::parse(slurp(folder / "bake.json"));
    EXPECT_GT(report["checkpoint"]["parts_found"].get<int>(), 0);
    return results_in(folder);
  }
  std::string at_once(const std::string& more) {
    const fs::path folder = scratch_.path / "once";
    fs::remove_all(folder);
    const CommandResult r = luxel("bake " + more + " -o " + folder.string());
    EXPECT_EQ(r.code, 0) << r.err;
    return results_in(folder);
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path / "parts";
};

// Three scenes, numbers of parts, and what decides how many rays there are.
TEST_F(BakesInParts, GiveTheBitsOfOneBake) {
  const std::pair<int, std::string> kinds[] = {
      {3, scene_file("cornell-box.glb") + " --resolution 96 --samples 64"},
      {8, scene_file("office.glb") + " --resolution 96 --max-error 0.1"},
      {2, scene_file("foliage.glb") + " --resolution 64 --samples 16 --layers per-light"}};
  for (const auto& [of, more] : kinds) {
    fs::remove_all(folder_);
    for (int number = 1; number <= of; ++number)
      EXPECT_GT(done(number, of, more)["parts_left"].get<int>(), 0);
    EXPECT_EQ(files_in(folder_).size(), size_t(of));
    EXPECT_EQ(merged(folder_.string()), at_once(more)) << more;
  }
}

// A pass goes on from what all parts have left, until the next stages need nothing more.
TEST_F(BakesInParts, GoOnFromEachOther) {
  const std::string more = scene_file("cornell-box.glb") + " --resolution 64 --max-error 0.05";
  int left = 1, passes = 0;
  for (; left > 0 && passes < 12; ++passes) {
    left = 0;
    for (const int number : {1, 2}) left += done(number, 2, more)["parts_left"].get<int>();
  }
  EXPECT_GT(passes, 2);
  EXPECT_EQ(left, 0);
  EXPECT_EQ(done(1, 2, more)["parts_kept"], 0);
  EXPECT_EQ(merged(folder_.string()), at_once(more));
}

// An array of one task, and processes that begin at the same time.
TEST_F(BakesInParts, MayBeOneOrRunTogether) {
  const std::string more = scene_file("cornell-box.glb") + " --resolution 64 --samples 64";
  EXPECT_EQ(done(1, 1, more)["parts_left"], 0);
  const std::string expected = at_once(more);
  EXPECT_EQ(merged((folder_ / "part-1-of-1.luxel").string()), expected);
  fs::remove_all(folder_);
  const auto quiet = [&](int number) { return luxel(part(number, 3, more)).code; };
  std::thread first([&] { EXPECT_EQ(quiet(1), 0); }), second([&] { EXPECT_EQ(quiet(2), 0); });
  EXPECT_EQ(quiet(3), 0);
  first.join(), second.join();
  EXPECT_EQ(merged(folder_.string()), expected);
}

// A part that is killed goes on where it stood; what no part has, merge does itself.
TEST_F(BakesInParts, LoseNothingButWhatWasUnderWay) {
  const std::string more = scene_file("cornell-box.glb") + " --resolution 128 --samples 256";
  const fs::path file = folder_ / "part-1-of-2.luxel";
  {
    Running command(part(1, 2, more));
    std::error_code none;
    while (!command.ended() && !(fs::file_size(file, none) > 500'000 && !none))
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ASSERT_TRUE(command.end_with(SIGKILL));
  }
  const std::string cut = merged(file.string());
  EXPECT_GT(done(1, 2, more)["parts_found"].get<int>(), 0);
  EXPECT_EQ(merged(file.string()), cut);
  EXPECT_EQ(cut, at_once(more));
}

TEST_F(BakesInParts, AreRefusedWhereTheyCannotBe) {
  const std::string box = scene_file("cornell-box.glb") + " --resolution 32";
  const auto error = [](const std::string& arguments) {
    const CommandResult r = luxel(arguments);
    EXPECT_EQ(r.code, 1);
    EXPECT_THAT(r.out, IsEmpty());
    return r.err;
  };
  const std::string bake = "bake " + box + " -o " + folder_.string();
  for (const char* text : {"3", "0/4", "5/4", "1/x", "/", "-1/4"})
    EXPECT_THAT(error(bake + " --part " + text), HasSubstr("is not a part of a bake"));
  for (const std::string other : {"--keep", "--time-budget 5"})
    EXPECT_THAT(error(bake + " --part 1/2 " + other), HasSubstr("cannot be combined with"));
  EXPECT_THAT(error(bake + " --part 1/2 --solver hemicube"), HasSubstr("does not use --part"));
  EXPECT_THAT(error(bake + " --part 1/2 --plan"), HasSubstr("leave --part out"));
  EXPECT_FALSE(fs::exists(folder_));
  done(1, 2, box + " --samples 4");
  EXPECT_THAT(
      error(bake + " --samples 5 --part 1/2"),
      HasSubstr("part-1-of-2.luxel belongs to another bake: samples 4 there, 5 here; remove it"));
  EXPECT_THAT(error(bake + " --samples 5 --part 2/2"),
              HasSubstr("part-1-of-2.luxel belongs to another"));
  const std::string to = " -o " + (scratch_.path / "x").string();
  EXPECT_THAT(error("merge " + scratch_.path.string() + to), HasSubstr("has no parts of a bake"));
  ASSERT_EQ(shell("mkfifo " + (folder_ / "part-9-of-9.luxel").string()).code, 0);
  EXPECT_THAT(error("merge " + folder_.string() + to), HasSubstr("is not a file on a disk"));
  fs::remove(folder_ / "part-9-of-9.luxel");
  EXPECT_THAT(error("merge " + scene_file("office.glb") + to), HasSubstr("is damaged at byte 0"));
  EXPECT_THAT(error("merge " + folder_.string() + to + " --scene " + scene_file("office.glb")),
              HasSubstr("belongs to another bake: "));
  EXPECT_THAT(error("merge " + folder_.string() + to + " --scene absent.glb"),
              HasSubstr("absent.glb"));
}

}  // namespace
}  // namespace luxel::testing_support
