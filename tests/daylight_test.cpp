// Scenes that bring no light: every command lights them by the same clear day, and says so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <functional>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kPlate = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 1 2 3 4\n";

/// The walls of a cube, seen from inside; `faces` of 6 are there, the lid is the last.
std::string room(int faces) {
  const char* const walls[] = {"f 1 5 8 4\n", "f 2 3 7 6\n", "f 1 2 6 5\n",
                               "f 4 8 7 3\n", "f 1 4 3 2\n", "f 5 6 7 8\n"};
  std::string text = "v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 0 2 0\nv 2 2 0\nv 2 2 2\nv 0 2 2\n";
  for (int f = 0; f < faces; ++f) text += walls[f];
  return text;
}

/// A command's messages, and the bytes of a file that it leaves.
struct Left {
  std::string said, bytes;
};
Left left_by(const std::string& command, const std::filesystem::path& file) {
  const CommandResult r = luxel(command);
  EXPECT_EQ(r.code, 0) << command << "\n" << r.err;
  return {r.err, slurp(file)};
}

// The light is the one that the message names, bit for bit, whichever command was asked.
TEST(NoLight, IsTheSameClearDayForEveryCommand) {
  const ScratchFolder s;
  const std::string plate = s.write("plate.obj", kPlate).string();
  const auto bake = [&](const std::string& light) {
    return left_by(
        "bake " + plate + light + " --resolution 8 --samples 4 -o " + (s.path / "b").string(),
        s.path / "b" / "lightmap.exr");
  };
  const auto render = [&](const std::string& light) {
    return left_by("render " + plate + light + " --technique path --samples 2 --size 8x8 -o " +
                       (s.path / "r.exr").string(),
                   s.path / "r.exr");
  };
  constexpr const char* kSaid = "the scene has no light, so a clear sky lights it, --sky 135,40";
  for (const std::function<Left(const std::string&)>& command :
       {std::function<Left(const std::string&)>(bake), {render}}) {
    const Left chosen = command(""), asked = command(" --sky 135,40");
    EXPECT_THAT(chosen.said, HasSubstr(kSaid));
    EXPECT_THAT(asked.said, Not(HasSubstr("no light")));
    EXPECT_FALSE(chosen.bytes.empty());
    EXPECT_TRUE(chosen.bytes == asked.bytes);
  }
  EXPECT_THAT(luxel("probe " + plate + " --at 0.5,0,0.5").err, HasSubstr(kSaid));
  // bake.json says which it was, for viewers that show the sky.
  for (const char* light : {"", " --sky 135,40"}) {
    bake(light);
    const auto report = nlohmann::json::parse(slurp(s.path / "b" / "bake.json"));
    EXPECT_EQ(report.at("default_day"), *light == 0);
  }
}

// An .obj file cannot hold lights: its users cannot have ticked anything.
TEST(NoLight, SaysWhatAnObjFileCanHold) {
  const ScratchFolder s;
  const std::string plate = s.write("plate.obj", kPlate).string();
  const CommandResult r = luxel("render " + plate + " --technique path --samples 1 --size 4x4 -o " +
                                (s.path / "r.png").string());
  EXPECT_THAT(r.err, HasSubstr("Ke in its .mtl"));
}

// No light gets into a closed room, whatever the sky: black, and a sentence says what to do. With
// the lid off there is nothing to say.
TEST(NoLight, SaysWhyAClosedRoomIsBlack) {
  const ScratchFolder s;
  const auto said = [&](int faces) {
    const std::string file = s.write("room.obj", room(faces)).string();
    return luxel("bake " + file + " --resolution 16 --samples 16 -o " + (s.path / "b").string())
        .err;
  };
  EXPECT_THAT(said(6),
              HasSubstr("every surface is black because no light gets there; a closed room"));
  EXPECT_THAT(said(5), Not(HasSubstr("is black")));
}

}  // namespace
}  // namespace luxel::testing_support
