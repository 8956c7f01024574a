// luxel-view of an .lxr file: lamps that a play moves, in a window and without one.
#include <gmock/gmock.h>

#include <numeric>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/flip.h"
#include "luxel/scene/shapes.h"
#include "tests/pictures.h"
#include "tests/relight_command.h"
#include "tests/view_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

CommandResult view_lamps(const std::string& arguments, const std::string& before = "") {
  return shell(before + " " LUXEL_VIEW_BINARY " " + arguments);
}

class ViewOfLamps : public ::testing::Test {
 protected:
  void SetUp() override {
    lxr_ = (s_.path / "box.lxr").string();
    ASSERT_EQ(make(lxr_, "").code, 0);
    const CommandResult r = view_lamps(lxr_ + offscreen("first.png"));
    if (r.err.find("Vulkan") != std::string::npos || r.err.find("device") != std::string::npos)
      GTEST_SKIP() << r.err;
    ASSERT_EQ(r.code, 0) << r.err;
  }
  std::string offscreen(const std::string& name) const {
    return " --size 80x60 --offscreen --screenshot " + (s_.path / name).string();
  }
  std::string play_of(const std::string& events) const {
    return " --play " +
           s_.write("play.json", R"({"end": 0.3, "events": [)" + events + "]}").string();
  }
  std::string shown(const std::string& events) const {
    const CommandResult r = view_lamps(lxr_ + offscreen("played.png") + play_of(events));
    EXPECT_EQ(r.code, 0) << r.err;
    return slurp(s_.path / "played.png");
  }

  ScratchFolder s_;
  std::string lxr_;
};

// The box's own lamp goes out, and a red one comes that is moved to the left.
const std::string kRedLamp = R"({"at": 0, "key": "m"},
  {"at": 0, "material": "light", "radiance": [0, 0, 0]},
  {"at": 0, "new_lamp": "point", "to": [0.1, 0.4, 0.1], "intensity": [0.03, 0, 0]},
  {"at": 0.2, "lamp": 0, "to": [0.45, 0.4, 0.1]})";

TEST_F(ViewOfLamps, IsWhatAPlayMakesOfThem) {
  const std::string first = slurp(s_.path / "first.png");
  EXPECT_EQ(shown(R"({"at": 0, "key": "m"})"), first) << "there is no lamp to mark";
  const std::string moved = shown(kRedLamp);
  EXPECT_NE(moved, first);
  const image::Image picture = png_at(s_.path / "played.png");
  double left = 0, right = 0, other = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 12; x < 68; ++x) {  // beside the box there is nothing, which is grey
      (x < 40 ? left : right) += double(picture.rgb(x, y).x);
      other += double(picture.rgb(x, y).z);
    }
  EXPECT_GT(left, 1.2 * right);
  EXPECT_GT(left, 4 * other) << "red light alone";
  // Off again, and what glowed glows as it did.
  EXPECT_EQ(shown(R"({"at": 0, "new_lamp": "point", "on": false}, {"at": 0, "key": "m"})"), first);
}

// `luxel relight` draws the saved script by rays and with its own look-up of texels.
TEST_F(ViewOfLamps, SavesAScriptThatRelightDraws) {
  const CommandResult saved =
      view_lamps(lxr_ + offscreen("window.png") +
                 play_of(kRedLamp + R"(, {"at": 0.25, "scroll": 1}, {"at": 0.25, "key": "+"},
                                        {"at": 0.25, "key": "ctrl+s"})"));
  ASSERT_EQ(saved.code, 0) << saved.err;
  const auto script = s_.path / "box-lamps.json";
  EXPECT_THAT(saved.err, HasSubstr("wrote " + script.string()));
  const CommandResult drawn = play(lxr_, script, s_.path / "frames");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  const image::Image window = png_at(s_.path / "window.png"),
                     frame = png_at(s_.path / "frames" / "frame-0000.png"),
                     first = png_at(s_.path / "first.png");
  const auto mean_flip = [&](const image::Image& picture) {
    const image::Image flip = image::flip(window, picture);
    return std::accumulate(flip.data.begin(), flip.data.end(), 0.0) / double(flip.data.size());
  };
  EXPECT_LT(mean_flip(frame), 0.05);
  EXPECT_GT(mean_flip(first), 0.2);
}

// The path tracer lights the same lamps, or its light would be another altogether.
TEST_F(ViewOfLamps, AreComparedWithPaths) {
  const CommandResult r =
      view_lamps(lxr_ + offscreen("compared.png") +
                 play_of(kRedLamp + R"(, {"at": 0.25, "key": "c"}, {"at": 0.25, "wait": "bake"})"));
  ASSERT_EQ(r.code, 0) << r.err;
  constexpr std::string_view kBefore = " texels differs from the path tracer's by ";
  const size_t at = r.err.find(kBefore);
  ASSERT_NE(at, std::string::npos) << r.err;
  const double percent = std::stod(r.err.substr(at + kBefore.size()));
  EXPECT_GT(percent, 0.1) << "there are only 300 patches";
  EXPECT_LT(percent, 20);
}

/// A pole on a floor under a sun whose disc is so wide, and a camera above its shadow.
scene::Scene pole_in_the_sun(float disc_deg) {
  scene::Scene out;
  const uint32_t grey = scene::add_material(out, "grey", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(out, {-1, 3, -1, 2}, 0, true, grey);
  scene::Mesh pole;
  scene::add_box(pole, {-0.15f, 0, -0.15f}, {0.15f, 2, 0.15f}, grey);
  scene::place(out, std::move(pole));
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional, sun.intensity = {1, 1, 1};
  sun.direction = normalize(Vec3{1, -1, 0.3f});
  sun.angular_radius_rad = 0.5f * disc_deg * kPi / 180;
  out.lights = {sun};
  scene::Camera camera;
  camera.world_from_camera = scene::look_at({1.2f, 3, 0.35f}, {1.2f, 0, 0.35f}, {0, 0, -1});
  out.cameras = {camera};
  return out;
}

class ViewOfSuns : public ViewOfLamps {
 protected:
  void SetUp() override {
    if (!has_device(s_)) GTEST_SKIP() << "no device";
  }
  std::string scene_of(float disc_deg, const std::string& name) const {
    const auto glb = export_::scene_glb(pole_in_the_sun(disc_deg));
    EXPECT_TRUE(glb && write_file_atomically(s_.path / name, *glb));
    return (s_.path / name).string();
  }
  image::Image rendered(const std::string& scene) const {
    const std::string baked = (s_.path / "baked").string(), to = (s_.path / "bake.png").string();
    EXPECT_EQ(luxel("bake " + scene + " --resolution 512 --samples 64 --quiet -o " + baked).code,
              0);
    EXPECT_EQ(luxel("render " + scene + " --from " + baked + kSize + "-o " + to).code, 0);
    return png_at(s_.path / "bake.png");
  }
  image::Image in_a_window(const std::string& scene, const std::string& events) const {
    const std::string lxr = (s_.path / "sun.lxr").string();
    EXPECT_EQ(luxel("relight " + scene + kSmall + "--quiet -o " + lxr).code, 0);
    EXPECT_EQ(
        view_lamps(lxr + kSize + "--offscreen --screenshot " + (s_.path / "sun.png").string() +
                   play_of(R"({"at": 0, "key": "m"})" + events))
            .code,
        0);
    return png_at(s_.path / "sun.png");
  }
  static double mean_flip(const image::Image& a, const image::Image& b) {
    const image::Image flip = image::flip(a, b);
    return std::accumulate(flip.data.begin(), flip.data.end(), 0.0) / double(flip.data.size());
  }
  inline static const std::string kSize = " --size 240x180 ";
};

// The bake asks rays to all of the disc, the window its maps of shadows.
TEST_F(ViewOfSuns, AreAsSoftAsInABake) {
  const std::string soft = scene_of(8, "soft.glb"), hard = scene_of(0, "hard.glb");
  const image::Image wanted = rendered(soft), of_file = in_a_window(soft, ""),
                     sharp = in_a_window(hard, ""),
                     of_desk = in_a_window(hard, R"(, {"at": 0, "lamp": 0, "disc_deg": 8})");
  // 0.016, and 0.066 with a hard shadow.
  EXPECT_LT(mean_flip(of_file, wanted), 0.03);
  EXPECT_GT(mean_flip(sharp, wanted), 2 * mean_flip(of_file, wanted));
  EXPECT_LT(mean_flip(of_desk, of_file), 1e-3) << "whoever made it so wide";
}

TEST_F(ViewOfLamps, AWindowShowsTheSame) {
  if (!has_virtual_display()) GTEST_SKIP() << "needs Xvfb (package xvfb)";
  const std::string size = " --size 200x150",
                    play = play_of(kRedLamp + R"(, {"at": 0.25, "key": "m"})");
  const CommandResult window = view_lamps(
      lxr_ + size + play + " --screenshot " + (s_.path / "window.png").string(), kInWindow);
  ASSERT_EQ(window.code, 0) << window.err;
  EXPECT_EQ(window.out + window.err, "") << "the validation layer has nothing to say";
  ASSERT_EQ(view_lamps(lxr_ + size + play + " --offscreen --screenshot " +
                       (s_.path / "without.png").string())
                .code,
            0);
  EXPECT_EQ(slurp(s_.path / "window.png"), slurp(s_.path / "without.png"));
}

TEST_F(ViewOfLamps, SaysWhatIsWrong) {
  const auto error = [&](const std::string& arguments) {
    const CommandResult r = view_lamps(arguments);
    EXPECT_EQ(r.code, 1) << r.err;
    EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << "one line: " << r.err;
    return r.err;
  };
  EXPECT_THAT(error(lxr_ + offscreen("x.png") + play_of(R"({"at": 0, "lamp": 0, "on": true})")),
              HasSubstr("play.json, at 0 s: there is no lamp 0; there are 0"));
  const std::string other = (s_.path / "other.lxr").string();
  ASSERT_EQ(make(other, "--target vertices").code, 0);
  EXPECT_THAT(error(other + offscreen("x.png")),
              HasSubstr("other.lxr: it was made without texels to light"));
  s_.write("damaged.lxr", "no such thing");
  EXPECT_THAT(error((s_.path / "damaged.lxr").string() + offscreen("x.png")),
              HasSubstr("damaged.lxr"));
  EXPECT_THAT(error((s_.path / "absent.lxr").string() + offscreen("x.png")),
              HasSubstr("absent.lxr"));
}

}  // namespace
}  // namespace luxel::testing_support
