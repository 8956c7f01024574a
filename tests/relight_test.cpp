// `luxel relight` from outside: the file it makes, the pictures it plays, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "image/codec.h"
#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

const std::string kBox = scene_file("cornell-box.glb");
const std::string kSmall = " --patches 300 --rays 256 --resolution 32 ";

/// `luxel relight` of the Cornell box.
CommandResult make(const std::filesystem::path& lxr, const std::string& options) {
  return luxel("relight " + kBox + kSmall + options + " -o " + lxr.string());
}

/// A lamp goes from the right to the left of the box.
constexpr const char* kMoves = R"({"frames": 4, "frames_per_second": 2, "size": [32, 24],
  "lights": [{"position": [{"at": 0, "value": [0.1, 0.45, 0.1]},
                           {"at": 1.5, "value": [0.45, 0.45, 0.1]}], "intensity": [1, 1, 1]}],
  "emission": [{"material": "light", "radiance": [0, 0, 0]}]})";

CommandResult play(const std::filesystem::path& lxr, const std::filesystem::path& script,
                   const std::filesystem::path& output, const std::string& options = "") {
  return luxel("relight --play " + lxr.string() + " --script " + script.string() + " -o " +
               output.string() + " " + options);
}

image::Image8 picture(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  EXPECT_TRUE(bytes) << path;
  return bytes ? *image::decode_ldr(*bytes, path.string()) : image::Image8{};
}

/// Mean of 0..255 over the columns [from, to) of a picture, all channels.
double mean_of(const image::Image8& p, int from, int to) {
  double sum = 0;
  const int channels = int(p.data.size()) / (p.width * p.height);
  for (int y = 0; y < p.height; ++y)
    for (int x = from; x < to; ++x)
      for (int c = 0; c < 3; ++c) sum += p.data[size_t((y * p.width + x) * channels + c)];
  return sum / (3.0 * p.height * (to - from));
}

TEST(RelightCommand, SaysWhatItMade) {
  const ScratchFolder s;
  const CommandResult r = make(s.path / "a.lxr", "--json --max-error 0.05");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(files_in(s.path), std::set<std::string>{"a.lxr"});
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["settings"]["patches"], 300);
  EXPECT_EQ(json["settings"]["rays"], 256);
  EXPECT_EQ(json["settings"]["codec"], "hierarchical");
  EXPECT_EQ(json["settings"]["max_error"], 0.05);
  EXPECT_EQ(json["settings"]["bounces"], -1);
  EXPECT_EQ(json["settings"]["target"], "texels");
  EXPECT_NEAR(double(json["counts"]["patches"]), 300, 45);  // within 15 %, docs/matrix.md
  EXPECT_GT(json["counts"]["places"], 100);
  EXPECT_LE(json["counts"]["places"], 32 * 32);
  EXPECT_EQ(json["counts"]["triangles"], 38);  // info's
  EXPECT_EQ(json["bytes"]["file"], std::filesystem::file_size(s.path / "a.lxr"));
  EXPECT_LT(json["bytes"]["matrix"], json["bytes"]["file"]);
  EXPECT_GT(double(json["codec_error"]), 0);
  EXPECT_LE(double(json["codec_error"]), 0.05);
  EXPECT_GT(double(json["seconds"]["form factors"]), 0);
  EXPECT_TRUE(json["warnings"].empty());
}

TEST(RelightCommand, EveryCodecCanBePlayed) {
  const ScratchFolder s;
  const auto moves = s.write("moves.json", kMoves);
  std::set<std::string> files;
  for (const char* codec : {"hierarchical", "lowrank", "bc1", "dense32", "dense16"}) {
    const auto lxr = s.path / (std::string(codec) + ".lxr");
    const CommandResult r = make(lxr, std::string("--codec ") + codec);
    ASSERT_EQ(r.code, 0) << codec << r.err;
    ASSERT_EQ(play(lxr, moves, s.path / codec).code, 0) << codec;
    // The same light, but for a few percent.
    EXPECT_NEAR(mean_of(picture(s.path / codec / "frame-0000.png"), 0, 32),
                mean_of(picture(s.path / "hierarchical" / "frame-0000.png"), 0, 32), 5)
        << codec;
    files.insert(slurp(lxr));
  }
  EXPECT_EQ(files.size(), 5u);
}

TEST(RelightCommand, TexelsAndVerticesShowTheSameLight) {
  const ScratchFolder s;
  const auto moves = s.write("moves.json", kMoves);
  for (const char* target : {"texels", "vertices"}) {
    ASSERT_EQ(make(s.path / "a.lxr", std::string("--target ") + target).code, 0) << target;
    const CommandResult r = play(s.path / "a.lxr", moves, s.path / target);
    ASSERT_EQ(r.code, 0) << target << r.err;
  }
  // The box has vertices in its corners alone, whose light is not that of the middle of its walls:
  // indirect light, a third of all, may be off by a third.
  const double texels = mean_of(picture(s.path / "texels" / "frame-0000.png"), 0, 32);
  const double vertices = mean_of(picture(s.path / "vertices" / "frame-0000.png"), 0, 32);
  EXPECT_NEAR(vertices, texels, 0.11 * texels);
}

TEST(RelightCommand, GivesTheSameBitsWithAnyNumberOfThreads) {
  const ScratchFolder s;
  const auto moves = s.write("moves.json", kMoves);
  for (const char* threads : {"1", "2"}) {
    const auto lxr = s.path / (std::string(threads) + ".lxr");
    ASSERT_EQ(make(lxr, std::string("--threads ") + threads).code, 0);
    ASSERT_EQ(play(lxr, moves, s.path / threads, std::string("--threads ") + threads).code, 0);
  }
  EXPECT_EQ(slurp(s.path / "1.lxr"), slurp(s.path / "2.lxr"));
  for (const char* frame : {"frame-0000.png", "frame-0003.png"})
    EXPECT_EQ(slurp(s.path / "1" / frame), slurp(s.path / "2" / frame)) << frame;
}

TEST(RelightCommand, RefusesWhatCannotBeMade) {
  const ScratchFolder s;
  for (const auto& [options, sentence] :
       {std::pair{"--codec zip", "--codec zip is not known; there is: hierarchical, "},
        std::pair{"--codec bc1 --patches 30000", "--patches 30000 are too many for --codec bc1"},
        std::pair{"--target faces", "--target faces is not known; there is: texels, "},
        std::pair{"--max-error 2", "--max-error 2 is outside 0.00001 to 1"},
        std::pair{"--max-error 0", "--max-error 0 is outside"},
        std::pair{"--bounces 2000", "--bounces 2000 is outside 0 to 1000"},
        std::pair{"--patches 0", "--patches 0 is outside 1 to"},
        std::pair{"--rays 0", "--rays 0 is outside 1 to"},
        std::pair{"--resolution 0", "--resolution 0 is outside"},
        std::pair{"--texels-per-metre -1", "--texels-per-metre -1 is not a density"},
        std::pair{"--max-memory 1M", "1 MiB may be used; ask for fewer"},
        std::pair{"--script moves.json", "--script is for --play FILE.lxr"}}) {
    const CommandResult r =
        luxel("relight " + kBox + " " + options + " -o " + (s.path / "a.lxr").string());
    EXPECT_EQ(r.code, std::string(options).find("memory") != std::string::npos ? 3 : 1) << options;
    EXPECT_THAT(r.err, HasSubstr(sentence)) << options;
    EXPECT_TRUE(files_in(s.path).empty()) << options;
  }
  const std::string here = (s.path / "a").string();
  EXPECT_THAT(luxel("relight " + kBox + " -o " + here + ".txt").err,
              HasSubstr("a.txt: the file is to end in .lxr"));
  EXPECT_THAT(luxel("relight -o " + here + ".lxr").err, HasSubstr("give a SCENE"));
  EXPECT_THAT(luxel("relight nothing.glb -o " + here + ".lxr").err, HasSubstr("no such file"));
  EXPECT_EQ(luxel("relight " + kBox).code, 2);  // no -o
  EXPECT_TRUE(files_in(s.path).empty());
}

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

TEST_F(Playing, WithoutLightIsBlackAndLampsStayWhenKept) {
  const std::string dark = R"("emission": [{"material": "light", "radiance": [0, 0, 0]}])";
  const std::string head = R"({"frames": 1, "size": [16, 12], "exposure": 0, )";
  ASSERT_EQ(play(lxr(), s.write("dark.json", head + dark + "}"), s.path / "dark").code, 0);
  EXPECT_EQ(mean_of(picture(s.path / "dark" / "frame-0000.png"), 0, 16), 0);
  // As baked: its lamp of 17, 12, 4 is white in the picture, and the box is lit.
  ASSERT_EQ(play(lxr(), s.write("baked.json", head + R"("lights": []})"), s.path / "baked").code,
            0);
  EXPECT_GT(mean_of(picture(s.path / "baked" / "frame-0000.png"), 0, 16), 40);
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
    EXPECT_THAT(r.err, HasSubstr("is for making a file, not for --play; leave it out")) << option;
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
  const CommandResult r = run(lxr().string() + " 20");
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
