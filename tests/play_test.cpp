// `luxel relight --play` and examples/relight from outside: pictures, times, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/relight_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

/// One small file for all tests of playing.
class Playing : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder;
    const CommandResult r = make(lxr(), "");
    ASSERT_EQ(r.code, 0) << r.err;
  }
  static void TearDownTestSuite() { delete folder; }
  static std::filesystem::path lxr() { return folder->path / "box.lxr"; }
  static ScratchFolder* folder;
  const ScratchFolder s;
};
ScratchFolder* Playing::folder = nullptr;

// Texels of the floor lie half under the box. Those whose middle is inside have no light of their
// own, and made dark spots at its foot: 0.85 of the light a hand beside it.
TEST_F(Playing, TheFootOfABoxIsNotDark) {
  const auto foot = s.write("foot.json", R"({"frames": 1, "size": [160, 120],
    "camera": {"eye": [0.1, 0.25, -0.1], "look_at": [0.2, 0, 0.2], "fov_deg": 50},
    "lights": [{"position": [0.1, 0.45, 0.1], "intensity": [1, 1, 1]}],
    "emission": [{"material": "light", "radiance": [0, 0, 0]}]})");
  ASSERT_EQ(luxel("relight " + kBox + " --patches 300 --rays 256 --resolution 64 -o " +
                  (s.path / "a.lxr").string())
                .code,
            0);
  ASSERT_EQ(play(s.path / "a.lxr", foot, s.path / "f").code, 0);
  const image::Image8 p = picture(s.path / "f" / "frame-0000.png");
  ASSERT_EQ(p.width, 160);
  const auto sum_at = [&](int x, int y) {
    const size_t channels = p.data.size() / size_t(p.width * p.height);
    const uint8_t* pixel = &p.data[size_t(y * p.width + x) * channels];
    return pixel[0] + pixel[1] + pixel[2];
  };
  EXPECT_GT(sum_at(115, 70), 0.95 * sum_at(130, 72));
}

TEST_F(Playing, LeavesAPictureAndARowPerFrame) {
  const CommandResult r = play(lxr(), s.write("moves.json", kMoves), s.path / "f", "--json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path / "f"),
            (std::set<std::string>{"frame-0000.png", "frame-0001.png", "frame-0002.png",
                                   "frame-0003.png", "frames.csv"}));
  std::istringstream csv(slurp(s.path / "f" / "frames.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "frame,time_s,direct_ms,bounces_ms,places_ms,update_ms,draw_ms");
  for (int k = 0; k < 4; ++k) {
    ASSERT_TRUE(std::getline(csv, line));
    int frame = -1;
    double time_s = 0, direct = 0, bounces = 0, places = 0, update = 0, draw = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf,%lf,%lf,%lf,%lf", &frame, &time_s, &direct,
                          &bounces, &places, &update, &draw),
              7)
        << line;
    EXPECT_EQ(frame, k);
    EXPECT_EQ(time_s, 0.5 * k);  // 2 frames per second
    EXPECT_GT(bounces, 0);
    EXPECT_NEAR(update, direct + bounces + places, 0.0021);  // four roundings of 0.0005
    EXPECT_GE(draw, 0);
  }
  EXPECT_FALSE(std::getline(csv, line));
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["width"], 32);
  EXPECT_EQ(json["height"], 24);
  ASSERT_EQ(json["frames"].size(), 4u);
  EXPECT_EQ(json["frames"][3]["time_s"], 1.5);
  EXPECT_GT(double(json["frames"][3]["update_ms"]), 0);
}

TEST_F(Playing, TheLightGoesWithTheLamp) {
  ASSERT_EQ(play(lxr(), s.write("moves.json", kMoves), s.path / "f").code, 0);
  const auto first = picture(s.path / "f" / "frame-0000.png");
  const auto last = picture(s.path / "f" / "frame-0003.png");
  ASSERT_EQ(first.width, 32);
  ASSERT_EQ(first.height, 24);
  EXPECT_GT(mean_of(first, 0, 32), 40);  // of 255
  // x grows to the left of the published camera's picture: the lamp goes from the right to the
  // left.
  EXPECT_GT(mean_of(first, 18, 28), 1.15 * mean_of(last, 18, 28));
  EXPECT_GT(mean_of(last, 4, 14), 1.15 * mean_of(first, 4, 14));
}

TEST_F(Playing, WithoutLightIsBlack) {
  const std::string dark = R"("emission": [{"material": "light", "radiance": [0, 0, 0]}])";
  // From inside of the box: beside it there is nothing, which is grey.
  const std::string head = R"({"frames": 1, "size": [16, 12], "exposure": 0,
      "camera": {"eye": [0.278, 0.273, 0.05], "look_at": [0.278, 0.273, 0.5]}, )";
  ASSERT_EQ(play(lxr(), s.write("dark.json", head + dark + "}"), s.path / "dark").code, 0);
  EXPECT_EQ(mean_of(picture(s.path / "dark" / "frame-0000.png"), 0, 16), 0);
  // As baked: its lamp of 17, 12, 4 is white in the picture, and the box is lit.
  ASSERT_EQ(play(lxr(), s.write("baked.json", head + R"("lights": []})"), s.path / "baked").code,
            0);
  EXPECT_GT(mean_of(picture(s.path / "baked" / "frame-0000.png"), 0, 16), 40);
}

TEST_F(Playing, TheScenesLampsStayWhenAskedTo) {
  // A plate of 0.8 under a sun of 1 from above and a black sky.
  const auto obj = s.write("plate.obj", "v 0 0 0\nv 0 0 2\nv 2 0 2\nv 2 0 0\nf 1 2 3 4\n");
  const auto plate = s.path / "plate.lxr";
  ASSERT_EQ(luxel("relight " + obj.string() + kSmall + "--sun 0,90,1 -o " + plate.string()).code,
            0);
  const auto light = [&](const std::string& field) {
    const auto script = s.write("plate.json", R"({"frames": 1, "size": [17, 17], "exposure": 0,
      "camera": {"eye": [1, 1, 1], "look_at": [1, 0, 1]}, )" +
                                                  field + "}");
    const CommandResult r = play(plate, script, s.path / "f");
    EXPECT_EQ(r.code, 0) << r.err;
    return mean_of(picture(s.path / "f" / "frame-0000.png"), 0, 17);
  };
  EXPECT_EQ(light(R"("keep_lights": false)"), 0);
  const double of_sun = light(R"("keep_lights": true)");
  EXPECT_GT(of_sun, 40);
  // The sun of the scene from the script, and a sky whose E = pi L is the same, but for a step of
  // 255.
  EXPECT_EQ(light(R"("lights": [{"kind": "directional", "direction": [0, -1, 0]}])"), of_sun);
  EXPECT_NEAR(light(R"("background": [0.318309886, 0.318309886, 0.318309886])"), of_sun, 1);
}

TEST_F(Playing, RefusesAndLeavesNothing) {
  const std::string bytes = slurp(lxr());
  const auto moves = s.write("moves.json", kMoves);
  const auto gold = s.write("gold.json", R"({"emission": [{"material": "gold",
    "radiance": [1, 1, 1]}]})");
  const auto door = s.write("door.json", R"({"camera": "door"})");
  const auto odd = s.write("odd.json", R"({"frames": "all"})");
  const auto cut = s.write("cut.lxr", bytes.substr(0, bytes.size() / 2));
  std::string changed = bytes;
  changed[bytes.size() / 2] ^= 1;
  const auto damaged = s.write("damaged.lxr", changed);
  const auto none = s.path / "none.lxr";
  ASSERT_EQ(make(none, "--target none").code, 0);
  const auto before = files_in(s.path);
  struct Case {
    std::filesystem::path lxr, script;
    std::string sentence;
  };
  for (const Case& c :
       {Case{lxr(), gold, "gold.json: the scene has no material 'gold'; it has: "},
        Case{lxr(), door, "the script's camera door is not in"},
        Case{lxr(), odd, "odd.json.frames is \"all\""},
        Case{lxr(), s.path / "no.json", "no.json: no such file"},
        Case{s.path / "no.lxr", moves, "no.lxr: no such file"},
        Case{kBox, moves, "is not an .lxr file"}, Case{cut, moves, "the file is damaged"},
        Case{damaged, moves, "the file is damaged"},
        Case{none, moves, "without places to light"}}) {
    const CommandResult r = play(c.lxr, c.script, s.path / "f");
    EXPECT_EQ(r.code, 1) << c.sentence;
    EXPECT_THAT(r.err, HasSubstr(c.sentence));
    EXPECT_EQ(files_in(s.path), before) << c.sentence;
  }
  for (const char* option : {"--patches 300", "--codec bc1", "--target none", "--bounces 3",
                             "--background 1,1,1", "--sun 0,45,1"}) {
    const CommandResult r = play(lxr(), moves, s.path / "f", option);
    EXPECT_EQ(r.code, 1) << option;
    EXPECT_THAT(r.err, HasSubstr("is for preparing a scene, not for --play; leave it out"))
        << option;
  }
  EXPECT_THAT(luxel("relight --play " + lxr().string() + " -o " + (s.path / "f").string()).err,
              HasSubstr("--play needs --script"));
  EXPECT_EQ(luxel("relight " + kBox + " --play " + lxr().string() + " -o f").code, 2);
  EXPECT_EQ(files_in(s.path), before);
}

TEST_F(Playing, KeepsWhatIsInTheFolder) {
  std::filesystem::create_directory(s.path / "f");
  s.write("f/note.txt", "mine");
  ASSERT_EQ(play(lxr(), s.write("moves.json", kMoves), s.path / "f").code, 0);
  EXPECT_EQ(slurp(s.path / "f" / "note.txt"), "mine");
  EXPECT_EQ(files_in(s.path / "f").size(), 6u);
}

TEST_F(Playing, TheExampleProgramRelights) {
  const auto run = [&](const std::string& arguments) {
    const std::string out = (s.path / "out").string();
    const int status =
        std::system((LUXEL_RELIGHT_EXAMPLE " " + arguments + " >" + out + " 2>&1").c_str());
    return CommandResult{WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(out), ""};
  };
  // A floor and a ceiling that nothing but the program's lamp lights.
  const auto obj = s.write("slot.obj",
                           "v 0 0 0\nv 0 0 2\nv 2 0 2\nv 2 0 0\nf 1 2 3 4\n"
                           "v 0 1 0\nv 2 1 0\nv 2 1 2\nv 0 1 2\nf 5 6 7 8\n");
  const std::string dark = (s.path / "dark.lxr").string();
  ASSERT_EQ(luxel("relight " + obj.string() + kSmall + "-o " + dark).code, 0);
  const CommandResult r = run(dark + " 20");
  ASSERT_EQ(r.code, 0) << r.out;
  std::istringstream lines(r.out);
  std::string line;
  for (int k = 1; k <= 20; ++k) {
    ASSERT_TRUE(std::getline(lines, line));
    int update = 0;
    double ms = 0, light = -1;
    ASSERT_EQ(std::sscanf(line.c_str(), "update %d: %lf ms, read: %lf", &update, &ms, &light), 3);
    EXPECT_EQ(update, k);
    EXPECT_GT(ms, 0);
    EXPECT_GE(light, 0);
  }
  int read = 0;
  double light = 0;
  ASSERT_TRUE(std::getline(lines, line));
  ASSERT_EQ(std::sscanf(line.c_str(), "%d of 20 results read, the last: %lf", &read, &light), 2);
  EXPECT_GE(read, 1);
  EXPECT_GT(light, 0);
  const CommandResult without = run("");
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.out, HasSubstr("luxel relight SCENE -o FILE.lxr"));
  const CommandResult wrong = run(kBox);
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.out, HasSubstr("is not an .lxr file"));
}

}  // namespace
}  // namespace luxel::testing_support
