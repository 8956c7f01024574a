// luxel-view of a scene whose lamps are to move: it is prepared as `luxel relight` does, once.
#include <gmock/gmock.h>

#include "luxel/solve/matrix/lxr.h"
#include "tests/relight_command.h"
#include "tests/view_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

class ViewRelight : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_device(s_)) GTEST_SKIP() << "no device";
  }
  std::string at(const std::string& name) const { return (s_.path / name).string(); }
  CommandResult drawn(const std::string& arguments, const std::string& picture,
                      const std::string& events = "") const {
    const std::string play =
        " --play " + s_.write("play.json", R"({"end": 0, "events": [)" + events + "]}").string();
    return view(arguments + " --offscreen --size 80x60 --screenshot " + at(picture) +
                (events.empty() ? "" : play));
  }
  std::string relit(const std::string& options = "") const {
    return kBox + " --relight" + kSmall + options + " -o " + at("out");
  }

  ScratchFolder s_;
};

TEST_F(ViewRelight, PreparesTheFileOfRelightOnce) {
  const CommandResult r = drawn(relit(), "prepared.png");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("prepared " + at("out/relight.lxr")));
  ASSERT_EQ(make(s_.path / "box.lxr", "").code, 0);
  EXPECT_TRUE(slurp(at("out/relight.lxr")) == slurp(at("box.lxr")));
  ASSERT_EQ(drawn(at("box.lxr"), "box.png").code, 0);
  EXPECT_TRUE(slurp(at("prepared.png")) == slurp(at("box.png")));

  EXPECT_THAT(drawn(relit(), "again.png").err, HasSubstr("which was prepared earlier"));
  EXPECT_TRUE(slurp(at("again.png")) == slurp(at("box.png")));
  EXPECT_THAT(drawn(relit("--codec dense16"), "other.png").err, HasSubstr("prepared " + at("out")));
}

TEST_F(ViewRelight, KeepsMovedLampsInAnotherFile) {
  const CommandResult r = drawn(relit(), "moved.png", R"(
    {"at": 0, "new_lamp": "directional", "direction": [0, -1, 0], "disc_deg": 4},
    {"at": 0, "lamp": 0, "direction": [0, 0, 1], "intensity": [3, 2, 1]},
    {"at": 0, "material": "light", "radiance": [0, 1, 0]}, {"at": 0, "key": "ctrl+shift+s"})");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("wrote " + at("out/relight-lamps.lxr")));
  const auto saved = matrix::read_lxr(at("out/relight-lamps.lxr"));
  ASSERT_TRUE(saved) << saved.error().message;
  ASSERT_EQ(saved->lights.size(), 1u);
  EXPECT_EQ(saved->lights[0].direction, (Vec3{0, 0, 1}));
  EXPECT_EQ(saved->lights[0].intensity, (Rgb{3, 2, 1}));
  EXPECT_NEAR(saved->lights[0].angular_radius_rad, 2 * kPi / 180, 1e-6);
  const auto script = s_.write("kept.json", R"({"frames": 1, "size": [32, 24],
    "keep_lights": true, "lights": []})");
  EXPECT_EQ(play(at("out/relight-lamps.lxr"), script, s_.path / "frames").code, 0);
  EXPECT_EQ(drawn(at("out/relight-lamps.lxr"), "opened.png").code, 0);
}

// The bake that rests while lamps move begins anew, and comes to the same light.
TEST_F(ViewRelight, LeadsBackToTheBake) {
  const CommandResult r = drawn(relit("--samples 16"), "back.png", R"(
    {"at": 0, "material": "light", "radiance": [0, 1, 0]},
    {"at": 0, "key": "l"}, {"at": 0, "wait": "bake"}, {"at": 0, "key": "ctrl+s"})");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("prepared " + at("out/relight.lxr")));
  ASSERT_EQ(luxel("bake " + kBox + " --resolution 32 --samples 16 --quiet -o " + at("bake")).code,
            0);
  EXPECT_TRUE(slurp(at("out/lightmap.exr")) == slurp(at("bake/lightmap.exr")));
}

TEST_F(ViewRelight, SaysWhatIsWrong) {
  const auto error = [&](const std::string& arguments, const std::string& events = "") {
    const CommandResult r = drawn(arguments, "x.png", events);
    EXPECT_EQ(r.code, 1) << r.err;
    EXPECT_EQ(r.err.find('\n'), r.err.size() - 1) << "one line: " << r.err;
    return r.err;
  };
  s_.write("box.lxr", "not looked at");
  EXPECT_THAT(error(at("box.lxr") + " --relight"), HasSubstr("is already prepared"));
  EXPECT_THAT(error(s_.path.string() + " --relight"),
              HasSubstr("--relight needs the file of a scene"));
  EXPECT_THAT(error(kBox + " --relight --inside hemicube"), HasSubstr("leave --inside out"));
  EXPECT_THAT(error(kBox + " --codec bc1"), HasSubstr("--codec is for --relight"));
  EXPECT_THAT(error(relit("--codec zip")), HasSubstr("--codec zip is not known"));
  EXPECT_THAT(error(relit("--max-error 2")), HasSubstr("--max-error 2 is outside 0.00001 to 1"));
  EXPECT_FALSE(std::filesystem::exists(at("out"))) << "nothing was made";
  EXPECT_THAT(error(relit(), R"({"at": 0, "instance": "tall block", "to": [0, 0, 0]})"),
              HasSubstr("open the scene itself to change more"));
}

}  // namespace
}  // namespace luxel::testing_support
