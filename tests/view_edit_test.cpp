// luxel-view of a scene: what a play edits is drawn, and saved, and the saved file is the same
// scene.
#include <gmock/gmock.h>

#include <numeric>

#include "luxel/base/file.h"
#include "luxel/export/baked_glb.h"
#include "luxel/image/flip.h"
#include "luxel/scene/procedural.h"
#include "tests/pictures.h"
#include "tests/relight_command.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

class ViewOfEdits : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto glb = export_::scene_glb(scene::cornell_box());
    ASSERT_TRUE(glb);
    ASSERT_TRUE(write_file_atomically(s_.path / "box.glb", *glb));
  }
  CommandResult view(const std::string& scene, const std::string& picture,
                     const std::string& events) const {
    return shell(" " LUXEL_VIEW_BINARY " " + (s_.path / scene).string() +
                 " --resolution 64 --samples 16 --size 80x60 --offscreen --screenshot " +
                 (s_.path / picture).string() + " -o " + (s_.path / "out").string() + " --play " +
                 s_.write("play.json", R"({"end": 0, "events": [)" + events + "]}").string());
  }

  ScratchFolder s_;
};

/// Pictures that do not depend on the exposure, which stays when a scene is edited.
const std::string kLook = R"({"at": 0, "key": "m"}, {"at": 0, "show": "irradiance"},
  {"at": 0, "range": [0, 20]}, {"at": 0, "wait": "bake"})";

double mean_flip(const image::Image& a, const image::Image& b) {
  const image::Image flip = image::flip(a, b);
  return std::accumulate(flip.data.begin(), flip.data.end(), 0.0) / double(flip.data.size());
}

const std::string kEdits = R"(
  {"at": 0, "instance": "tall block", "to": [0.35, 0.165, 0.15], "angles_deg": [0, 40, 0]},
  {"at": 0, "material": "green", "reflectance": [0.1, 0.1, 0.9]},
  {"at": 0, "new_lamp": "point", "to": [0.15, 0.3, 0.3], "intensity": [2, 1, 0]})";

TEST_F(ViewOfEdits, AreDrawnAndSaved) {
  const CommandResult first = view("box.glb", "first.png", kLook);
  if (first.err.find("device") != std::string::npos) GTEST_SKIP() << first.err;
  ASSERT_EQ(first.code, 0) << first.err;
  const CommandResult edited = view("box.glb", "edited.png",
                                    kEdits + R"(,
    {"at": 0, "key": "esc"}, {"at": 0, "key": "ctrl+shift+s"}, )" +
                                        kLook);
  ASSERT_EQ(edited.code, 0) << edited.err;
  ASSERT_TRUE(std::filesystem::exists(s_.path / "out/box-edited.glb"));
  const CommandResult saved = view("out/box-edited.glb", "saved.png", kLook);
  ASSERT_EQ(saved.code, 0) << saved.err;
  const image::Image a = png_at(s_.path / "edited.png"), b = png_at(s_.path / "saved.png");
  EXPECT_LT(mean_flip(a, b), 0.03) << "as noisy";
  EXPECT_GT(mean_flip(a, png_at(s_.path / "first.png")), 0.1);
}

TEST_F(ViewOfEdits, HaveTheLightOfTheSavedFileBitByBit) {
  const CommandResult r = view("box.glb", "edited.png", kEdits + R"(,
    {"at": 0, "wait": "bake"}, {"at": 0, "key": "ctrl+s"}, {"at": 0, "key": "ctrl+shift+s"})");
  if (r.err.find("device") != std::string::npos) GTEST_SKIP() << r.err;
  ASSERT_EQ(r.code, 0) << r.err;
  const std::string out = (s_.path / "out").string(), baked = (s_.path / "baked").string();
  EXPECT_THAT(r.err, HasSubstr("wrote " + out + "; wrote " + out + "/box-edited.glb"));
  ASSERT_EQ(
      luxel("bake " + out + "/box-edited.glb --resolution 64 --samples 16 --quiet -o " + baked)
          .code,
      0);
  EXPECT_EQ(slurp(out + "/lightmap.exr"), slurp(baked + "/lightmap.exr"));
}

TEST_F(ViewOfEdits, SayWhatIsNotThere) {
  const CommandResult r = view("box.glb", "none.png", R"({"at": 0, "select": "chair"})");
  if (r.err.find("device") != std::string::npos) GTEST_SKIP() << r.err;
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("the scene has nothing of the name 'chair'"));
}

}  // namespace
}  // namespace luxel::testing_support
