// luxel-view and its files: others that are opened, parts of a bake, turns; and what goes wrong.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>

#include "luxel/image/color.h"
#include "tests/command.h"
#include "tests/pictures.h"
#include "tests/view_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

class ViewFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const CommandResult r = run("absent --offscreen --screenshot x.png");
    if (r.err.find("device") != std::string::npos || r.err.find("Vulkan") != std::string::npos)
      GTEST_SKIP() << "no graphics device";
  }
  CommandResult run(const std::string& arguments, const std::string& before = "") const {
    return shell("cd " + s_.path.string() + " && " + before + " " LUXEL_VIEW_BINARY " " +
                 arguments);
  }
  std::string baked(const std::string& name, const std::string& scene, const std::string& more) {
    const std::string folder = (s_.path / name).string();
    EXPECT_EQ(luxel("bake " + scene_file(scene) + " -o " + folder + " --quiet " + more).code, 0);
    return folder;
  }
  /// Options that play these events.
  std::string play(const std::string& events, const std::string& end = "0") {
    return " --size 96x96 --play " +
           s_.write("play.json", "{\"end\": " + end + ", \"events\": [" + events + "]}").string();
  }
  image::Image picture(const std::string& arguments, const std::string& before = "") {
    const CommandResult r = run(arguments + " --screenshot shot.png", before);
    EXPECT_EQ(r.code, 0) << r.err;
    if (!before.empty()) {
      EXPECT_EQ(r.out + r.err, "") << "the validation layer has nothing to say";
    }
    return png_at(s_.path / "shot.png");
  }
  const ScratchFolder s_;
};

/// Mean difference of display values.
double apart(const image::Image& a, const image::Image& b) {
  double sum = 0;
  if (a.data.size() != b.data.size()) return 1;
  for (size_t i = 0; i < a.data.size(); ++i)
    sum += std::abs(double(image::srgb_from_linear(a.data[i])) -
                    double(image::srgb_from_linear(b.data[i])));
  return sum / double(a.data.size());
}

const std::string kIrradiance = R"({"at": 0, "show": "irradiance"}, {"at": 0, "range": [0, 0.8]})";
constexpr const char* kFewTexels = "--resolution 64 --samples 16";

TEST_F(ViewFiles, AWindowWithoutASubjectWaitsForOne) {
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string state = "XDG_STATE_HOME=" + (s_.path / "state").string();
  const CommandResult r = run("", state + " " + kInWindow + " timeout 3");
  EXPECT_EQ(r.code, 124) << "it is still open";
  EXPECT_EQ(r.out + r.err, "");
}

// Light of no reflection beside a bake, and of a scene while it is baked, is that of a bake of
// none.
TEST_F(ViewFiles, ShowPartsOfTheLight) {
  const std::string a = baked("a", "cornell-box.glb", kFewTexels);
  const CommandResult none =
      run(a + play(R"({"at": 0, "part": "direct"})") + " --offscreen --screenshot x.png");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("bounces-0 --bounces 0`"));
  const std::string direct =
      baked("a/bounces-0", "cornell-box.glb", std::string(kFewTexels) + " --bounces 0");
  const std::string part = kIrradiance + R"(, {"at": 0, "part": "direct"})";
  const image::Image wanted = picture(direct + play(kIrradiance) + " --offscreen");
  EXPECT_LT(apart(picture(a + play(part) + " --offscreen"), wanted), 1e-3);
  const std::string scene = scene_file("cornell-box.glb") + " " + kFewTexels;
  // Its seams are not stitched.
  EXPECT_LT(apart(picture(scene + play(part) + " --offscreen"), wanted), 5e-3);
  const image::Image all = picture(a + play(kIrradiance) + " --offscreen");
  EXPECT_GT(apart(all, wanted), 0.05);
  EXPECT_LT(apart(picture(a + play(part + R"(, {"at": 0, "part": "all"})") + " --offscreen"), all),
            1e-3);
  const CommandResult more =
      run(a + play(R"({"at": 0, "bounces": 1})") + " --offscreen --screenshot x.png");
  EXPECT_THAT(more.err, HasSubstr("light of 1 bounces is not known separately, only up to 0"));
}

TEST_F(ViewFiles, ShowProbes) {
  const std::string a = baked("a", "cornell-box.glb", std::string(kFewTexels) + " --probes 0.15");
  const image::Image with = picture(a + play(R"({"at": 0, "probes": true})") + " --offscreen");
  EXPECT_GT(apart(with, picture(a + play("") + " --offscreen")), 0.01);
  const std::string b = baked("b", "cornell-box.glb", kFewTexels);
  const CommandResult none =
      run(b + play(R"({"at": 0, "probes": true})") + " --offscreen --screenshot x.png");
  EXPECT_THAT(none.err, HasSubstr("there are no probes in"));
}

TEST_F(ViewFiles, TurnAround) {
  const std::string a = baked("a", "cornell-box.glb", kFewTexels);
  ASSERT_EQ(run(a + " --offscreen --size 96x96 --turntable 4 --screenshot turn.png").code, 0);
  const auto turned = [&](const char* number) {
    return slurp(s_.path / ("turn-" + std::string(number) + ".png"));
  };
  ASSERT_EQ(run(a + " --offscreen --size 96x96 --screenshot still.png").code, 0);
  EXPECT_EQ(turned("000"), slurp(s_.path / "still.png"));
  EXPECT_NE(turned("001"), turned("000"));
  EXPECT_NE(turned("001"), turned("003"));
  EXPECT_FALSE(std::filesystem::exists(s_.path / "turn-004.png"));
  // A quarter of a turn lasts five seconds.
  const std::string quarter = R"({"at": 0, "key": "o"}, {"at": 5, "key_up": "o"})";
  EXPECT_LT(
      apart(picture(a + play(quarter, "5") + " --offscreen"), png_at(s_.path / "turn-001.png")),
      0.01);
}

// A file that cannot be opened changes nothing.
TEST_F(ViewFiles, OpenInAWindow) {
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string a = baked("a", "cornell-box.glb", kFewTexels);
  const std::string b = baked("b", "furnace-box.glb", kFewTexels);
  const auto opening = [&](const std::string& path) {
    return play(R"({"at": 0, "open": ")" + path + R"("}, {"at": 0.1, "wait": "bake"})", "0.2");
  };
  EXPECT_EQ(picture(a + opening(b), kInWindow).data, picture(b + play("") + " --offscreen").data);
  EXPECT_EQ(picture(a + opening((s_.path / "absent").string()), kInWindow).data,
            picture(a + play("") + " --offscreen").data);
  const std::string broken = s_.write("broken.glb", "glTF").string();
  EXPECT_EQ(picture(a + opening(broken), kInWindow).data,
            picture(a + play("") + " --offscreen").data);
  const std::string first = scene_file("cornell-box.glb") + " " + kFewTexels;
  const std::string second = scene_file("furnace-box.glb");
  EXPECT_LT(apart(picture(first + opening(second), kInWindow),
                  picture(second + " " + kFewTexels + play("") + " --offscreen")),
            1e-3);
  const CommandResult refused = run(a + opening(b) + " --offscreen --screenshot x.png");
  EXPECT_THAT(refused.err, HasSubstr("are for a window"));
}

TEST_F(ViewFiles, AWindowThatClosesInMidBakeLeavesNothing) {
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const auto begin = std::chrono::steady_clock::now();
  const CommandResult r =
      run(scene_file("office.glb") + " --resolution 512 --samples 65535 -o saved" +
              play(R"({"at": 0.5, "close": "window"})", "1"),
          kInWindow);
  EXPECT_EQ(r.code, 0);
  EXPECT_EQ(r.out + r.err, "");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
  for (const auto& left : std::filesystem::directory_iterator(s_.path))
    EXPECT_EQ(left.path().filename(), "play.json");
}

TEST_F(ViewFiles, ALostDeviceIsASentence) {
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string a = baked("a", "cornell-box.glb", kFewTexels);
  const std::string before = slurp(s_.path / "a" / "lightmap.exr");
  const CommandResult r = run(a + play(R"({"at": 0.1, "lose": "device"})", "1"), kInWindow);
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("lost"));
  EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << "one line: " << r.err;
  EXPECT_EQ(slurp(s_.path / "a" / "lightmap.exr"), before);
}

/// Hills of 2 n^2 triangles under a sun, as PLY.
std::string hills(int n) {
  const auto put = [](auto value, std::string& to) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const size_t side = size_t(n) + 1;
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                    std::to_string(side * side) +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                    std::to_string(2 * size_t(n) * size_t(n)) +
                    "\nproperty list uchar int vertex_indices\nend_header\n";
  for (size_t i = 0; i < side * side; ++i) {
    const float x = float(i % side) / float(n), z = float(i / side) / float(n);
    put(x, out), put(0.03f * std::sin(20 * x) * std::sin(20 * z), out), put(z, out);
  }
  for (int i = 0; i < n * n; ++i) {
    const int a = i / n * int(side) + i % n, b = a + 1, c = a + int(side), d = c + 1;
    for (const auto& t : {std::array{a, c, b}, {b, c, d}}) {
      put(uint8_t(3), out);
      for (const int corner : t) put(corner, out);
    }
  }
  return out;
}

// The window shows colours as soon as the file is read, and closes though the bake has hardly
// begun.
TEST_F(ViewFiles, SlowMillionTrianglesAreDrawn) {
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string scene = s_.write("hills.ply", hills(708)).string();
  const auto begin = std::chrono::steady_clock::now();
  const image::Image shot =
      picture(scene + play(R"({"at": 0.2, "close": "window"})", "1"), kInWindow);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  rusage use{};
  getrusage(RUSAGE_CHILDREN, &use);
  std::printf("1,002,528 triangles: %.1f s, at most %.0f MiB\n", seconds,
              double(use.ru_maxrss) / 1024);
  double bright = 0;
  for (const float v : shot.data) bright += v > 0.05f;
  EXPECT_GT(bright / double(shot.data.size()), 0.05) << "hills are seen";
}

}  // namespace
}  // namespace luxel::testing_support
