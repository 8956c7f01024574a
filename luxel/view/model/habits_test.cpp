// Habits come back bit by bit; a file of anything else is refused and left alone.
#include "luxel/view/model/habits.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <limits>

namespace luxel::view {
namespace {

using ::testing::HasSubstr;

/// Nothing about its numbers is round.
scene::Camera some_camera(float x) {
  scene::Camera out;
  out.world_from_camera = translation({x / 3, 0.1f, -1e-7f * x});
  out.fov_y_rad = 0.7f, out.aspect = 4.0f / 3, out.orthographic_height_m = x / 7;
  return out;
}

void expect_same(const scene::Camera& a, const scene::Camera& b) {
  EXPECT_EQ(a.world_from_camera, b.world_from_camera);
  EXPECT_EQ(a.fov_y_rad, b.fov_y_rad);
  EXPECT_EQ(a.aspect, b.aspect);
  EXPECT_EQ(a.orthographic_height_m, b.orthographic_height_m);
}

SubjectHabits some_subject(const std::string& path) {
  SubjectHabits out;
  out.path = path;
  out.view = LastView{some_camera(1), some_camera(2)};
  out.bookmarks[2] = Bookmark{some_camera(3), 0.3f, Show::texels};
  out.bookmarks[8] = Bookmark{some_camera(4), 5, Show::light};
  return out;
}

TEST(Habits, ComeBackBitByBit) {
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / "state" / "luxel" / "view.json";
  std::filesystem::remove_all(file.parent_path().parent_path());
  const auto none = read_habits(file);
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_TRUE(none->recent.empty());
  Habits habits;
  habits.is_light = true;
  habits.panel = {std::array{7.5f, -3.0f}, {4000000000u, 2}, {1}};
  habits.window = std::array{1234, 765};
  remember(some_subject("/a b/\"c\""), habits);
  ASSERT_TRUE(write_habits(habits, file));
  const auto read = read_habits(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->is_light);
  EXPECT_EQ(read->panel, habits.panel);
  EXPECT_EQ(read->window, habits.window);
  ASSERT_EQ(read->recent.size(), 1u);
  const SubjectHabits back = subject_of(*read, "/a b/\"c\"");
  ASSERT_TRUE(back.view && back.bookmarks[2] && back.bookmarks[8]);
  expect_same(back.view->first, some_camera(1));
  expect_same(back.view->last, some_camera(2));
  expect_same(back.bookmarks[2]->camera, some_camera(3));
  EXPECT_EQ(back.bookmarks[2]->brightness, 0.3f);
  EXPECT_EQ(back.bookmarks[2]->show, Show::texels);
  EXPECT_EQ(back.bookmarks[8]->show, Show::light);
  for (const size_t other : {0u, 1u, 3u, 7u}) EXPECT_FALSE(back.bookmarks[other]);
  EXPECT_FALSE(subject_of(*read, "/elsewhere").view);
}

TEST(Habits, KnowTheNewestSubjectsOnce) {
  Habits habits;
  for (int i = 0; i < 25; ++i) remember(some_subject(fmt::format("/{}", i)), habits);
  remember(some_subject("/10"), habits);
  ASSERT_EQ(habits.recent.size(), kMostRecent);
  EXPECT_EQ(habits.recent[0].path, "/10");
  EXPECT_EQ(habits.recent[1].path, "/24");
  EXPECT_EQ(habits.recent.back().path, "/5");
}

TEST(Habits, BeginWithTheLastViewWhereTheFirstIsTheSame) {
  const SubjectHabits subject = some_subject("/a");
  expect_same(camera_to_begin(subject, some_camera(1)), some_camera(2));
  expect_same(camera_to_begin(subject, some_camera(5)), some_camera(5));
  expect_same(camera_to_begin({}, some_camera(1)), some_camera(1));
}

// Where a scene's origin has become another one, cameras stay where they are in the world.
TEST(Habits, AreMovedToAnotherOrigin) {
  SubjectHabits subject;
  subject.path = "/far", subject.origin = {5403216.5, 0, -64};
  scene::Camera camera;
  camera.world_from_camera = translation({0.25f, 1, 8});
  subject.view = LastView{camera, camera};
  subject.bookmarks[1] = Bookmark{camera, 1, Show::light};
  Habits habits;
  remember(subject, habits);
  const auto read = parse_habits(json_of(habits), "view.json");
  ASSERT_TRUE(read) << read.error().message;
  const SubjectHabits back = subject_of(*read, "/far");
  EXPECT_EQ(back.origin, subject.origin);
  expect_same(moved_to(subject.origin, back).view->last, camera);
  const SubjectHabits moved = moved_to({5403208, 0, -32}, back);
  EXPECT_EQ(moved.origin, (DVec3{5403208, 0, -32}));
  camera.world_from_camera = translation({8.75f, 1, -24});
  expect_same(moved.view->first, camera), expect_same(moved.view->last, camera);
  ASSERT_TRUE(moved.bookmarks[1]);
  expect_same(moved.bookmarks[1]->camera, camera);
}

TEST(Habits, LeaveOutWhatCannotBeReadAgain) {
  Habits habits;
  remember(some_subject("/a"), habits);
  SubjectHabits& subject = habits.recent[0];
  subject.path = "/\xff";  // no UTF-8
  subject.view->last.world_from_camera.row[1][2] = std::numeric_limits<float>::quiet_NaN();
  subject.bookmarks[2]->brightness = std::numeric_limits<float>::infinity();
  const auto read = parse_habits(json_of(habits), "view.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->recent[0].view);
  EXPECT_FALSE(read->recent[0].bookmarks[2]);
  EXPECT_TRUE(read->recent[0].bookmarks[8]);
}

TEST(Habits, SayWhatIsNoFileOfThem) {
  Habits habits;
  remember(some_subject("/a"), habits);
  const std::string right = json_of(habits);
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string out = right;
    const size_t at = out.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return out.replace(at, what.size(), instead);
  };
  for (const std::string& wrong :
       {std::string(), std::string("[]"), std::string("{}"), right.substr(0, 99),
        with("\"dark\"", "\"blue\""), with("\"texels\"", "\"nothing\""),
        with("\"3\": {", "\"0\": {"), with("\"fov_y_rad\": 0.", "\"fov_y_rad\": -0."),
        with("\"/a\"", "7"), with("\"brightness\": ", "\"brightness\": -")}) {
    const auto read = parse_habits(wrong, "view.json");
    ASSERT_FALSE(read) << wrong;
    EXPECT_THAT(read.error().message, HasSubstr("view.json: "));
    EXPECT_THAT(read.error().message, HasSubstr("nothing is remembered"));
  }
}

TEST(Habits, LieWhereTheEnvironmentSays) {
  EXPECT_EQ(habits_file("/s", "/home/u"), "/s/luxel/view.json");
  for (const char* unset : {static_cast<const char*>(nullptr), "", "not/absolute"})
    EXPECT_EQ(habits_file(unset, "/home/u"), "/home/u/.local/state/luxel/view.json");
  EXPECT_EQ(habits_file(nullptr, nullptr), "");
}

}  // namespace
}  // namespace luxel::view
