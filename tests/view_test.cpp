// luxel-view without a window: it draws what `luxel render --from` draws, and says what is missing.
#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <sstream>

#include "luxel/image/color.h"
#include "luxel/image/false_color.h"
#include "luxel/image/flip.h"
#include "tests/pictures.h"
#include "tests/view_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

class ViewOfABake : public ::testing::TestWithParam<const char*> {};

TEST_P(ViewOfABake, IsWhatRenderDraws) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const std::string scene = scene_file(GetParam()), bake = (s.path / "baked").string();
  ASSERT_EQ(luxel("bake " + scene + " -o " + bake + " --resolution 128 --samples 16 --quiet").code,
            0);
  const CommandResult seen =
      view(bake + " --offscreen --screenshot " + (s.path / "view.png").string());
  ASSERT_EQ(seen.code, 0) << seen.err;
  // preview.png is the picture of `luxel render --from`, and says with what it was taken. 0.002 to
  // 0.008 for 4 samples per pixel and not 9, and mipmaps; 0.03 more where one level of 255 is
  // rounded otherwise all over the sky.
  const image::Image flip =
      image::flip(png_at(s.path / "view.png"), png_at(s.path / "baked/preview.png"));
  const double mean =
      std::accumulate(flip.data.begin(), flip.data.end(), 0.0) / double(flip.data.size());
  EXPECT_LT(mean, 0.05);
  EXPECT_GT(mean, 0) << "the same file";
  // Up and down again is where it was; what is played is drawn.
  const auto played = [&](const std::string& keys) {
    const auto events = s.write("play.json", "{\"end\": 2, \"events\": [" + keys + "]}");
    const CommandResult r = view(bake + " --offscreen --size 60x45 --play " + events.string() +
                                 " --screenshot " + (s.path / "played.png").string());
    EXPECT_EQ(r.code, 0) << r.err;
    return png_at(s.path / "played.png");
  };
  const auto apart = [](const image::Image& a, const image::Image& b) {
    const image::Image d = image::flip(a, b);
    return std::accumulate(d.data.begin(), d.data.end(), 0.0) / double(d.data.size());
  };
  const std::string up = R"({"at": 0, "key": "e"}, {"at": 1, "key_up": "e"})";
  const std::string down = R"(, {"at": 1, "key": "q"}, {"at": 2, "key_up": "q"})";
  // The camera comes back to the last bits of its place: a few pixels may be rounded otherwise.
  const image::Image still = played("");
  EXPECT_LT(apart(played(up + down), still), 0.001);
  EXPECT_GT(apart(played(up), still), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ViewOfABake,
                         ::testing::Values("cornell-box.glb", "foliage.glb", "tiled-kit.glb"));

/// Mean difference of display values where the first picture is not black, as it is where there is
/// no surface.
double apart_where_not_black(const image::Image& a, const image::Image& b) {
  double sum = 0, count = 0;
  for (size_t i = 0; i + 2 < std::min(a.data.size(), b.data.size()); i += 3) {
    if (a.data[i] + a.data[i + 1] + a.data[i + 2] == 0) continue;
    for (size_t c = i; c < i + 3; ++c)
      sum += std::abs(image::srgb_from_linear(a.data[c]) - image::srgb_from_linear(b.data[c]));
    count += 3;
  }
  return sum / std::max(count, 1.0);
}

// texels.png and error.png on the surfaces, and the irradiance of each pixel in false colours, as
// `luxel render` draws them.
TEST(View, LooksIntoABakeAsRenderDoes) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const std::string scene = scene_file("cornell-box.glb"), bake = (s.path / "baked").string();
  ASSERT_EQ(luxel("bake " + scene + " -o " + bake +
                  " --resolution 128 --samples 16 --texels --error-map --quiet")
                .code,
            0);
  const auto render = [&](const std::string& technique, const std::string& file) {
    EXPECT_EQ(luxel("render " + scene + " --from " + bake + " --technique " + technique +
                    " --size 240x240 --quiet -o " + (s.path / file).string())
                  .code,
              0);
  };
  const auto look = [&](const std::string& events) {
    const auto play = s.write("play.json", R"({"end": 0, "events": [)" + events + "]}");
    const std::string file = (s.path / "view.png").string();
    const CommandResult r = view(bake + " --offscreen --size 240x240 --play " + play.string() +
                                 " --screenshot " + file);
    EXPECT_EQ(r.code, 0) << r.err;
    return png_at(file);
  };
  for (const std::string kind : {"texels", "error"}) {
    render(kind, kind + ".png");
    const image::Image wanted = png_at(s.path / (kind + ".png"));
    // 0.012 at most, at edges of squares: other samples in each pixel.
    EXPECT_LT(apart_where_not_black(wanted, look(R"({"at": 0, "show": ")" + kind + "\"}")), 0.02)
        << kind;
    EXPECT_GT(apart_where_not_black(wanted, look(R"({"at": 0, "show": "charts"})")), 0.05);
  }
  render("irradiance", "e.exr");
  image::Image wanted = exr_at(s.path / "e.exr"), shown(240, 240, 3);
  for (int i = 0; i < 240 * 240; ++i) {
    if (wanted.at(i % 240, i / 240)[3] < 1) continue;  // black: does not count
    const image::Color8 c =
        image::false_color(double(luminance(wanted.rgb(i % 240, i / 240)) / 0.8f));
    for (size_t k = 0; k < 3; ++k)
      shown.data[3 * size_t(i) + k] = image::linear_from_srgb(float(c[k]) / 255);
  }
  const image::Image seen =
      look(R"({"at": 0, "show": "irradiance"}, {"at": 0, "range": [0, 0.8]})");
  EXPECT_LT(apart_where_not_black(shown, seen), 0.01);
}

// A bake beside itself differs by nothing; beside another one it does, and a window shows the same.
TEST(View, ShowsTwoBakesBesideOneAnother) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const std::string a = (s.path / "a").string(), b = (s.path / "b").string();
  for (const auto& [folder, samples] : {std::pair(a, "16"), {b, "1"}})
    ASSERT_EQ(luxel("bake " + scene_file("cornell-box.glb") + " -o " + folder +
                    " --resolution 64 --samples " + samples + " --quiet")
                  .code,
              0);
  const auto shot = [&](const std::string& beside, const std::string& mode, const char* more = "",
                        const std::string& before = "") {
    const auto play =
        s.write("play.json", R"({"end": 0, "events": [{"at": 0, "beside": ")" + mode + "\"}]}");
    const std::string file = (s.path / "view.png").string();
    const CommandResult r = view(a + " --beside " + beside + " --size 160x160 --play " +
                                     play.string() + " --screenshot " + file + " " + more,
                                 before);
    EXPECT_EQ(r.code, 0) << r.err;
    if (!before.empty()) {
      EXPECT_EQ(r.out + r.err, "") << "the validation layer has nothing to say";
    }
    return png_at(file);
  };
  const auto nothing = [&](const image::Image& picture) {
    const image::Color8 dark = image::false_color(0);
    for (size_t i = 0; i < picture.data.size(); ++i)
      if (std::abs(picture.data[i] - image::linear_from_srgb(float(dark[i % 3]) / 255)) > 1e-5f)
        return false;
    return true;
  };
  for (const std::string mode : {"difference", "flip"}) {
    EXPECT_TRUE(nothing(shot(a, mode, "--offscreen"))) << mode;
    const image::Image other = shot(b, mode, "--offscreen");
    EXPECT_FALSE(nothing(other)) << mode;
    if (!has_virtual_display()) continue;
    const image::Image window = shot(b, mode, "", kInWindow);
    EXPECT_EQ(window.data, other.data) << mode;
  }
  const CommandResult refused = view(scene_file("cornell-box.glb") + " --beside " + a);
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--beside needs a first bake to compare with"));
}

// Layers at half of their light, and an exposure of one stop more: what was baked. Without one
// lamp its side of the room is dark.
TEST(View, MixesLayers) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  const std::string bake = (s.path / "baked").string();
  ASSERT_EQ(luxel("bake " + scene_file("office.glb") + " -o " + bake +
                  " --resolution 64 --samples 4 --layers per-light --quiet")
                .code,
            0);
  const auto layer = [](const std::string& name, const std::string& dimmer) {
    return R"({"at": 0, "layer": {"name": ")" + name + R"(", "dimmer": )" + dimmer + "}}";
  };
  const auto look = [&](const std::string& events) {
    const auto play = s.write("play.json", R"({"end": 0, "events": [)" + events + "]}");
    const std::string file = (s.path / "view.png").string();
    const CommandResult r =
        view(bake + " --offscreen --size 120x90 --play " + play.string() + " --screenshot " + file);
    EXPECT_EQ(r.code, 0) << r.err;
    return png_at(file);
  };
  const image::Image baked = look("");
  const std::string brighter =
      R"({"at": 0, "key": "+"}, {"at": 0, "key_up": "+"}, {"at": 0, "key": "+"})";
  const image::Image mixed =
      look(layer("light__left", "0.5") + ", " + layer("light__right", "0.5") + ", " + brighter);
  EXPECT_LT(apart_where_not_black(baked, mixed), 0.002);
  EXPECT_GT(apart_where_not_black(baked, look(layer("light__left", "0"))), 0.02);
}

// A virtual display, the panel over the picture, and a window of another size than the bake's.
TEST(View, AWindowShowsWhatIsDrawnWithoutOne) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string bake = (s.path / "baked").string();
  ASSERT_EQ(luxel("bake " + scene_file("cornell-box.glb") + " -o " + bake +
                  " --resolution 64 --samples 4 --quiet")
                .code,
            0);
  const std::string play = s.write("play.json", R"({"end": 0.3, "events": [
        {"at": 0, "pointer": [100, 80]}, {"at": 0, "press": "left"},
        {"at": 0.1, "pointer": [130, 90]}, {"at": 0.2, "release": "left"},
        {"at": 0.2, "scroll": 1}, {"at": 0.2, "key": "+"}, {"at": 0.25, "key": "w"}]})")
                               .string();
  const auto shot = [&](const std::string& name) {
    return " --size 200x150 --play " + play + " --screenshot " + (s.path / name).string();
  };
  const std::string state = (s.path / "state").string();
  const CommandResult window =
      view(bake + shot("window.png"), "XDG_STATE_HOME=" + state + " " + kInWindow);
  ASSERT_EQ(window.code, 0) << window.err;
  EXPECT_EQ(window.out + window.err, "") << "the validation layer has nothing to say";
  EXPECT_FALSE(std::filesystem::exists(state)) << "a play is not remembered";
  ASSERT_EQ(view(bake + shot("without.png") + " --offscreen").code, 0);
  EXPECT_EQ(slurp(s.path / "window.png"), slurp(s.path / "without.png"));
}

/// The column of a table of frames.
std::vector<double> column_of(const std::filesystem::path& csv, size_t column) {
  std::vector<double> out;
  std::istringstream in(slurp(csv));
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {
    std::istringstream cells(line);
    std::string cell;
    for (size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    out.push_back(std::stod(cell));
  }
  return out;
}

// The window begins with a draft, fades the bake's light in, saves it, and ends as the picture
// without a window does.
TEST(View, ASceneIsBakedWhileItIsLookedAt) {
  const ScratchFolder s;
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string scene = scene_file("office.glb") + " --resolution 128 --samples 16 ";
  ASSERT_EQ(luxel("bake " + scene + " -o " + (s.path / "baked").string() + " --quiet").code, 0);
  const std::string play = s.write("play.json", R"({"end": 0.2, "events": [
        {"at": 0.1, "wait": "bake"}, {"at": 0.1, "key": "ctrl+s"}]})")
                               .string();
  const auto shot = [&](const std::string& name) {
    return scene + " --size 120x90 --play " + play + " --screenshot " + (s.path / name).string();
  };
  const CommandResult window = view(shot("window.png") + " -o " + (s.path / "saved").string() +
                                        " --frame-times " + (s.path / "frames.csv").string(),
                                    kInWindow);
  ASSERT_EQ(window.code, 0) << window.err;
  EXPECT_EQ(window.out + window.err, "wrote " + (s.path / "saved").string() + "\n");
  ASSERT_EQ(view(shot("without.png") + " --offscreen").code, 0);
  EXPECT_EQ(slurp(s.path / "window.png"), slurp(s.path / "without.png"));
  for (const char* file : {"lightmap.exr", "baked.glb", "preview.png"})
    EXPECT_EQ(slurp(s.path / "saved" / file), slurp(s.path / "baked" / file)) << file;
  // Light never jumps once it is there; before it come the empty window and colours alone.
  const std::vector<double> brightness = column_of(s.path / "frames.csv", 2);
  const std::vector<double> has_light = column_of(s.path / "frames.csv", 4);
  ASSERT_GT(std::ranges::count(has_light, 1.0), 30) << "a second to fade in";
  for (size_t i = 1; i < brightness.size(); ++i)
    if (has_light[i - 1] == 1) {
      EXPECT_NEAR(brightness[i], brightness[i - 1], 0.02 * brightness[i - 1]) << i;
    }
}

TEST(View, SaysWhatIsWrong) {
  const ScratchFolder s;
  const std::string shot = " --offscreen --screenshot " + (s.path / "x.png").string();
  const auto error = [&](const std::string& arguments, int code, const std::string& before = "") {
    const CommandResult r = view(arguments, before);
    EXPECT_EQ(r.code, code) << r.err;
    EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << "one line: " << r.err;
    EXPECT_FALSE(std::filesystem::exists(s.path / "x.png"));
    return r.err;
  };
  EXPECT_THAT(error(shot, 2), HasSubstr("--offscreen and --play need a SUBJECT"));
  EXPECT_THAT(error("bake --offscreen", 2), HasSubstr("--offscreen requires --screenshot"));
  EXPECT_THAT(error("bake --screenshot x.png", 2), HasSubstr("needs --offscreen or --play"));
  EXPECT_THAT(error("bake --size 10 " + shot, 1), HasSubstr("--size '10' is not WIDTHxHEIGHT"));
  EXPECT_THAT(error("bake --size 99999x1 " + shot, 1), HasSubstr("each up to 16384"));
  EXPECT_THAT(error("bake --size '1\nluxel-view: done\x1b[2J'" + shot, 1),
              HasSubstr("'1\\nluxel-view: done\\x1b[2J'"));
  EXPECT_THAT(error("bake --offscreen --screenshot /nowhere/x.png", 1), HasSubstr("/nowhere"));
  // Drivers that are not there are no device.
  EXPECT_THAT(error("bake" + shot, 1, "VK_DRIVER_FILES=/absent VK_ICD_FILENAMES=/absent"),
              HasSubstr("Vulkan"));
  if (!has_device(s)) GTEST_SKIP() << "no graphics device";
  ASSERT_EQ(luxel("bake " + scene_file("cornell-box-empty.glb") + " -o " +
                  (s.path / "baked").string() + " --resolution 16 --samples 1 --quiet")
                .code,
            0);
  EXPECT_THAT(error((s.path / "baked").string(), 1, "env -u DISPLAY -u WAYLAND_DISPLAY"),
              HasSubstr("there is no display to open a window on; draw without a window with"));
  const std::string play = s.write("play.json", "{}").string();
  EXPECT_THAT(error("bake" + shot + " --play " + play, 1), HasSubstr("play.json: "));
  EXPECT_THAT(error("bake --device nonesuch" + shot, 1),
              HasSubstr("has 'nonesuch' in its name; the devices: "));
  const std::string baked = (s.path / "baked").string();
  const std::string texels =
      s.write("texels.json", R"({"end": 0, "events": [{"at": 0, "show": "texels"}]})").string();
  EXPECT_THAT(error(baked + shot + " --play " + texels, 1),
              HasSubstr("there is no texels.png in it; bake with --texels"));
  s.write("baked/error.png", slurp(std::filesystem::path(baked) / "preview.png"));
  EXPECT_THAT(error(baked + shot + " --play " + texels, 1),
              HasSubstr("720 pixels and the lightmap 16 x 16: they belong to different bakes"));
  EXPECT_THAT(error((s.path / "absent.glb").string() + shot, 1),
              HasSubstr("no scene and no bake named " + (s.path / "absent.glb").string()));
  EXPECT_THAT(error(s.path.string() + shot, 1), HasSubstr("it has no baked.glb"));
  const std::string broken = s.write("broken.glb", "glTF").string();
  EXPECT_THAT(error(broken + shot, 1), HasSubstr("broken.glb"));
  if (!has_virtual_display()) return;
  // A play that waits for a bake which fails does not wait for ever.
  const std::string wait =
      s.write("wait.json", R"({"end": 1, "events": [{"at": 0, "wait": "bake"}]})").string();
  EXPECT_THAT(error(broken + " --play " + wait, 1, kInWindow), HasSubstr("broken.glb"));
}

}  // namespace
}  // namespace luxel::testing_support
