// luxel-view --inside hemicube: plays of the workshop of hemicube radiosity, without a window.
#include <gmock/gmock.h>

#include <numeric>

#include "luxel/image/flip.h"
#include "tests/command.h"
#include "tests/pictures.h"

namespace luxel::testing_support {
namespace {

using ::testing::HasSubstr;

class ViewOfHemicubes : public ::testing::Test {
 protected:
  void SetUp() override {
    const CommandResult r = view("absent --offscreen");
    if (r.err.find("device") != std::string::npos || r.err.find("Vulkan") != std::string::npos)
      GTEST_SKIP() << "no graphics device";
  }
  /// Quick solutions, and pictures of 160 x 120.
  CommandResult view(const std::string& arguments) {
    return shell(" " LUXEL_VIEW_BINARY " " + arguments +
                 " --inside hemicube --size 160x120 --hemicube 8 --max-elements 2500 --max-error 0 "
                 "--direct-samples 4 --resolution 32 --screenshot " +
                 shot().string());
  }
  image::Image played(const std::string& models, const std::string& events) {
    const auto play = s_.write("play.json", R"({"end": 0, "events": [)" + events + "]}");
    const CommandResult r = view(models + " --offscreen --play " + play.string());
    EXPECT_EQ(r.code, 0) << r.err;
    return png_at(shot());
  }
  std::filesystem::path shot() const { return s_.path / "view.png"; }

  ScratchFolder s_;
};

double flip_between(const image::Image& a, const image::Image& b) {
  const image::Image map = image::flip(a, b);
  return std::accumulate(map.data.begin(), map.data.end(), 0.0) / double(map.data.size());
}

TEST_F(ViewOfHemicubes, IsWhatRenderDraws) {
  const std::string scene = scene_file("radiosity-box-with-shapes.glb");
  const std::string wanted = (s_.path / "wanted.png").string();
  for (const std::string technique : {"radiosity", "cads"}) {
    const std::string own =
        technique == "radiosity" ? " --hemicube 8 --max-elements 2500 --max-error 0" : "";
    ASSERT_EQ(luxel("render " + scene + " --technique " + technique + own +
                    " --size 160x120 --quiet -o " + wanted)
                  .code,
              0);
    const image::Image seen = played(scene, R"({"at": 0, "show": ")" + technique + "\"}");
    EXPECT_LT(flip_between(seen, png_at(wanted)), 0.05) << technique;
    EXPECT_GT(flip_between(played(scene, R"({"at": 0, "show": "elements"})"), seen), 0.2);
  }
}

TEST_F(ViewOfHemicubes, StopsWhereAPlaySaysAndShowsWhatAVertexSees) {
  const std::string scene = scene_file("cornell-box.glb");
  const image::Image whole = played(scene, "");
  const image::Image partly = played(scene, R"({"at": 0, "set": {"pause_at": 0.2}})");
  // Less light, and in a part of the picture the same as ever.
  EXPECT_GT(flip_between(partly, whole), 0.02);
  const std::string click =
      R"({"at": 0, "pointer": [40, 60]}, {"at": 0, "press": "left"}, {"at": 0, "release": "left"})";
  const std::string wait = R"(, {"at": 0, "wait": "bake"})";
  const image::Image seen = played(scene, click + wait);
  EXPECT_GT(flip_between(seen, whole), 0.02);
  EXPECT_EQ(played(scene, click + R"(, {"at": 0, "overlay": {"vertex": false}})" + wait).data,
            whole.data);
  for (const std::string other :
       {R"({"at": 0, "set": {"hemicube": 16}})", R"({"at": 0, "overlay": {"lit": true}})"})
    EXPECT_NE(played(scene, click + ", " + other + wait).data, seen.data) << other;
}

TEST_F(ViewOfHemicubes, PutsSeveralModelsIntoOneSceneAndSaysWhatIsWrong) {
  const std::string a = scene_file("cornell-box.glb"), b = scene_file("spheres-and-cube.glb");
  const std::string show = R"({"at": 0, "show": "c"})";
  EXPECT_GT(flip_between(played(a, show), played(a + " " + b, show)), 0.01);
  EXPECT_THAT(view(a + " absent.glb --offscreen").err, HasSubstr("absent.glb"));
  const auto play = s_.write("play.json", R"({"end": 0, "events": [{"at": 0, "show": "flat"}]})");
  const CommandResult r = view(a + " --offscreen --play " + play.string());
  EXPECT_EQ(r.code, 1);
  EXPECT_THAT(r.err, HasSubstr("does not show 'flat'"));
  const CommandResult two = shell(" " LUXEL_VIEW_BINARY " " + a + " " + b +
                                  " --offscreen --screenshot " + shot().string());
  EXPECT_EQ(two.code, 1);
  EXPECT_THAT(two.err, HasSubstr("several models"));
}

}  // namespace
}  // namespace luxel::testing_support
