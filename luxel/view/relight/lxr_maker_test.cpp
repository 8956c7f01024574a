// An .lxr file that is made in the background: it is luxel relight's, is made once, and leaves
// nothing where it is stopped.
#include "luxel/view/relight/lxr_maker.h"

#include <gmock/gmock.h>

#include <ctime>
#include <thread>

#include "luxel/base/file.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/solve/matrix/lxr.h"
#include "tests/scratch_folder.h"

namespace luxel::view {
namespace {

using ::testing::HasSubstr;

class LxrMakerTest : public ::testing::Test {
 protected:
  LxrMakerTest() {
    // In the open, where the check of the light by paths is short.
    scene::Scene scene;
    scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true,
                         scene::add_material(scene, "grey", {0.5f, 0.5f, 0.5f}));
    for (const char* name : {"first", "second", "third"}) {
      scene::PunctualLight lamp;
      lamp.name = name, lamp.position = {0.3f, 0.4f, 0.2f}, lamp.intensity = {1, 1, 1};
      scene.lights.push_back(lamp);
    }
    auto read = read_scene(std::move(scene), pipeline::BakeSettings{});
    EXPECT_TRUE(read);
    to_make_.read = *read, to_make_.now = unedited((*read)->scene);
    to_make_.settings.output = folder_.path / "new" / "relight.lxr";
    to_make_.settings.resolution = 16;
    to_make_.settings.matrix.patches.count = 100;
    to_make_.settings.matrix.factors.rays_per_patch = 64;
  }

  Result<MadeLxr> made() const {
    Progress progress;
    return make_lxr(to_make_, progress);
  }
  bool is_made_anew() const {
    const auto out = made();
    EXPECT_TRUE(out) << out.error().message;
    return out && !out->was_there;
  }
  std::filesystem::path file() const { return to_make_.settings.output; }

  testing_support::ScratchFolder folder_;
  LxrToMake to_make_;
};

TEST_F(LxrMakerTest, IsMadeOnceOfASceneAndItsSettings) {
  EXPECT_TRUE(is_made_anew());
  EXPECT_FALSE(is_made_anew());
  to_make_.settings.threads = 1;
  EXPECT_FALSE(is_made_anew()) << "no bit depends on it";
  to_make_.settings.seed = 2;
  EXPECT_TRUE(is_made_anew());
  to_make_.now.lamps[0].light.intensity = {2, 1, 1};
  EXPECT_TRUE(is_made_anew());
  auto bytes = *read_file(file());
  EXPECT_FALSE(is_made_anew());
  bytes.back() ^= std::byte(1);
  ASSERT_TRUE(write_file_atomically(file(), bytes));
  EXPECT_TRUE(is_made_anew()) << "the file is another one than was written";
  std::filesystem::remove(folder_.path / "new/relight.json");
  EXPECT_TRUE(is_made_anew()) << "whose it is nobody knows";
}

TEST_F(LxrMakerTest, IsMadeAnewWhereTheOriginIsAnotherOne) {
  EXPECT_TRUE(is_made_anew());
  scene::Scene moved = to_make_.read->scene;
  moved.origin = {1024, 0, -4096};
  to_make_.read = *read_scene(std::move(moved), pipeline::BakeSettings{});
  EXPECT_TRUE(is_made_anew()) << "its places are relative to that";
  EXPECT_FALSE(is_made_anew());
  EXPECT_EQ(matrix::read_lxr(file())->origin, to_make_.read->scene.origin);
}

TEST_F(LxrMakerTest, HasTheLampsAsTheyAreEdited) {
  to_make_.now.lamps[0].is_deleted = true, to_make_.now.lamps[1].is_on = false;
  const auto out = made();
  ASSERT_TRUE(out) << out.error().message;
  const std::vector<Lamp>& lamps = out->opened.lamps.lamps;
  ASSERT_EQ(lamps.size(), 2u);
  EXPECT_EQ(lamps[0].light.name, "second");
  EXPECT_FALSE(lamps[0].is_on);
  EXPECT_EQ(lamps[0].light.intensity, (Rgb{1, 1, 1})) << "as bright as before, when it is on again";
  EXPECT_TRUE(lamps[1].is_on);
  const std::vector<scene::PunctualLight>& lights = out->opened.light.relighter.data().lights;
  EXPECT_EQ(lights[0].intensity, Rgb{});
  EXPECT_EQ(lights[1].name, "third");
}

TEST_F(LxrMakerTest, StopsSoonAndLeavesNothing) {
  to_make_.read = *read_scene(scene::cornell_box(), pipeline::BakeSettings{});
  to_make_.now = unedited(to_make_.read->scene);
  // 2 billion rays: minutes of a processor.
  to_make_.settings.matrix.patches.count = 32768;
  to_make_.settings.matrix.factors.rays_per_patch = 65535;
  for (const int milliseconds : {0, 20, 300}) {
    auto maker = begin_lxr_maker();
    maker->ask(to_make_);
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    // Seconds of processors: the thread stands back behind all others of the machine. The bound is
    // what no slow machine comes near, and the work that is not stopped exceeds.
    const std::clock_t start = std::clock();
    maker.reset();
    EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 60);
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path)) << milliseconds;
  }
}

TEST_F(LxrMakerTest, SaysWhatCannotBeRelit) {
  scene::Scene scene = to_make_.read->scene;
  scene::LightProfile& profile = scene.profiles.emplace_back();
  profile.horizontal_rad = {0}, profile.vertical_rad = {0, kPi}, profile.candela = {100, 100};
  scene.lights[0].profile = 0;
  auto read = read_scene(std::move(scene), *to_make_.read);
  ASSERT_TRUE(read);
  to_make_.read = *read, to_make_.now = unedited((*read)->scene);
  const auto out = made();
  ASSERT_FALSE(out);
  EXPECT_THAT(out.error().message, HasSubstr("light 'first' has a light profile"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path));
}

}  // namespace
}  // namespace luxel::view
