// A user drags, scrolls and flies before a wall: where the camera gets to is known.
#include "luxel/view/model/walk.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "luxel/trace/camera_rays.h"
#include "luxel/view/model/play.h"

namespace luxel::view {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kWallWidth = 300, kWallHeight = 200;

/// The wall z = 0 without end.
std::optional<Vec3> on_the_wall(const Frame& frame, Vec2 pixel) {
  const trace::Ray ray =
      trace::CameraRays(frame.camera, kWallWidth, kWallHeight).through(pixel.x, pixel.y);
  const float t = -ray.origin.z / ray.direction.z;
  if (!(t > 0)) return std::nullopt;
  return ray.origin + ray.direction * t;
}

/// From z = 10 towards the wall; the scene is 10 m from corner to corner.
Walk before_the_wall() {
  Frame first;
  first.camera.world_from_camera = translation({0, 0, 10});
  first.exposure = 3;
  Box3 bounds;
  bounds.extend({-3, -4, 0}), bounds.extend({3, 4, 0});
  return begin_walk(first, bounds, kWallWidth, kWallHeight, on_the_wall);
}

Vec3 eye_of(const Walk& walk) { return column(walk.shown.camera.world_from_camera, 3); }

void expect_place(Vec3 a, Vec3 b) {
  EXPECT_LE(length(a - b), 1e-4f) << a.x << " " << a.y << " " << a.z << " for " << b.x << " " << b.y
                                  << " " << b.z;
}

void play_before_the_wall(const Play& events, Walk& walk) {
  play(
      events, [&](const Event& event) { handle(event, on_the_wall, walk); },
      [&](double seconds) { pass(seconds, walk); });
}

void drag(Button button, Vec2 from, Vec2 to, Walk& walk) {
  for (const Event& event : {Event(PointerMoved{from}), Event(ButtonChanged{button, true}),
                             Event(PointerMoved{to}), Event(ButtonChanged{button, false})})
    handle(event, on_the_wall, walk);
}

TEST(Walk, DraggingTurnsAboutWhatWasUnderThePointer) {
  Walk walk = before_the_wall();
  expect_place(walk.target, {0, 0, 0});
  const Vec3 place = *on_the_wall(walk.shown, {200, 50});
  drag(Button::left, {200, 50}, {250, 50}, walk);  // a quarter of the height: a quarter turn
  expect_place(walk.target, place);
  // From above: clockwise about the place, so that what is seen follows the pointer.
  expect_place(eye_of(walk), {place.x - 10, 0, place.z - place.x});
  drag(Button::left, {200, 50}, {100, 50}, walk);
  EXPECT_FALSE(walk.dragging);
  handle(PointerMoved{{0, 0}}, on_the_wall, walk);  // no button is down
  const Vec3 before = eye_of(walk);
  handle(PointerMoved{{90, 90}}, on_the_wall, walk);
  expect_place(eye_of(walk), before);
}

// A ball around a box of 2 m just fits into the picture's height.
TEST(Walk, FShowsWhatIsSelectedAndElseAll) {
  Walk walk = before_the_wall();
  walk.selected.extend({4, 1, -3}), walk.selected.extend({6, 3, -1});
  const auto press_f = [&] {
    for (const bool is_down : {true, false}) handle(KeyChanged{"f", is_down}, on_the_wall, walk);
  };
  press_f();
  expect_place(walk.target, {5, 2, -2});
  EXPECT_NEAR(length(eye_of(walk) - Vec3{5, 2, -2}),
              std::sqrt(3.0f) / std::sin(0.5f * walk.shown.camera.fov_y_rad), 1e-3f);
  walk.selected = {};
  press_f();
  expect_place(walk.target, {0, 0, 0});
}

TEST(Walk, DraggingWithAnotherButtonKeepsTheWallUnderThePointer) {
  for (const bool with_shift : {false, true}) {
    Walk walk = before_the_wall();
    if (with_shift) handle(KeyChanged{"shift", true}, on_the_wall, walk);
    const Vec3 place = *on_the_wall(walk.shown, {200, 50});
    drag(with_shift ? Button::left : Button::middle, {200, 50}, {80, 120}, walk);
    expect_place(*on_the_wall(walk.shown, {80, 120}), place);
  }
}

TEST(Walk, TheWheelGoesToWhatIsUnderThePointer) {
  Walk walk = before_the_wall();
  handle(PointerMoved{{200, 50}}, on_the_wall, walk);
  const Vec3 place = *on_the_wall(walk.shown, walk.pointer);
  handle(Scrolled{2}, on_the_wall, walk);
  EXPECT_NEAR(eye_of(walk).z, 8.1f, 1e-4f);
  expect_place(*on_the_wall(walk.shown, walk.pointer), place);
  handle(Scrolled{-2}, on_the_wall, walk);
  expect_place(eye_of(walk), {0, 0, 10});
  // Nothing is there: it goes on by parts of the distance to the target.
  const PlaceSeen nothing = [](const Frame&, Vec2) { return std::nullopt; };
  handle(Scrolled{2}, nothing, walk);
  EXPECT_NEAR(eye_of(walk).z, 8.1f, 1e-4f);
}

TEST(Walk, KeysFlyAsLongAsTheyAreDown) {
  Walk walk = before_the_wall();
  handle(KeyChanged{"w", true}, on_the_wall, walk);
  pass(0.5, walk);
  expect_place(eye_of(walk), {0, 0, 9});  // 2 m/s
  handle(KeyChanged{"shift", true}, on_the_wall, walk);
  pass(0.5, walk);
  expect_place(eye_of(walk), {0, 0, 5});
  handle(KeyChanged{"shift", false}, on_the_wall, walk);
  handle(KeyChanged{"s", true}, on_the_wall, walk);
  pass(5, walk);
  expect_place(eye_of(walk), {0, 0, 5});  // against each other
  for (const char* key : {"w", "s"}) handle(KeyChanged{key, false}, on_the_wall, walk);
  for (const char* key : {"d", "e"}) handle(KeyChanged{key, true}, on_the_wall, walk);
  pass(std::sqrt(0.5), walk);
  expect_place(eye_of(walk), {1, 1, 5});
}

TEST(Walk, KeysChooseWhatIsShown) {
  Walk walk = before_the_wall();
  const auto press = [&](const char* key) {
    handle(KeyChanged{key, true}, on_the_wall, walk);
    handle(KeyChanged{key, true}, on_the_wall, walk);  // a key that repeats does it once
    handle(KeyChanged{key, false}, on_the_wall, walk);
  };
  press("2");
  EXPECT_EQ(walk.shown.show, Show::light);
  press("3");
  EXPECT_EQ(walk.shown.show, Show::colour);
  press("1");
  EXPECT_EQ(walk.shown.show, Show::light_and_colour);
  press("+"), press("+");
  EXPECT_FLOAT_EQ(walk.shown.exposure, 6);
  press("-");
  EXPECT_FLOAT_EQ(walk.shown.exposure, 3 * std::sqrt(2.0f));
  press("0");
  EXPECT_EQ(walk.shown.exposure, 3);
  for (int i = 0; i < 400; ++i) press("-");
  EXPECT_GT(walk.shown.exposure, 0);
  drag(Button::left, {0, 0}, {30, 30}, walk);
  press("home");
  expect_place(eye_of(walk), {0, 0, 10});
  press("f");  // a ball of 5 m in 0.8 radians from top to bottom
  expect_place(eye_of(walk), {0, 0, 5 / std::sin(0.4f)});
  expect_place(walk.target, {0, 0, 0});
}

TEST(Walk, AKeyOfEveryLineOfTheListDoesSomething) {
  for (const KeyHelp& key : kKeys) {
    Walk walk = before_the_wall();
    walk.shown.show = Show::colour, walk.shown.exposure = 1;  // as after other keys
    if (std::string(key.key) == "3") walk.shown.show = Show::light;
    if (std::string(key.key) == ".") walk.shown.light.most = 2;
    walk.shown.camera = Frame{}.camera;
    walk.bookmarks[0] = bookmark_of(walk.first, 1);
    if (std::string(key.key) == "shift") handle(KeyChanged{"w", true}, on_the_wall, walk);
    Walk before = walk;
    handle(KeyChanged{key.key, true}, on_the_wall, walk);
    pass(0.1, walk);
    pass(0.1, before);
    const bool changed =
        walk.shown.show != before.shown.show || walk.shown.exposure != before.shown.exposure ||
        walk.bookmarks[0]->brightness != before.bookmarks[0]->brightness ||
        walk.shown.light != before.shown.light || walk.turns != before.turns ||
        walk.shown.shows_probes != before.shown.shows_probes ||
        walk.asked.size() != before.asked.size() || length(eye_of(walk) - eye_of(before)) > 0;
    EXPECT_TRUE(changed) << key.key;
  }
}

TEST(Walk, GoesToWhatWasRememberedThoughTheLightHasGrown) {
  const auto events = parse_play(R"({"end": 1, "events": [
    {"at": 0, "key": "ctrl+2"}, {"at": 0, "key_up": "ctrl+2"}, {"at": 0, "scroll": 2},
    {"at": 0, "key": "2"}, {"at": 0, "key": "+"}, {"at": 0, "key": "ctrl+9"},
    {"at": 0, "key": "3"}, {"at": 0, "scroll": 5}, {"at": 0, "key": "-"}]})",
                                 "walk.json");
  ASSERT_TRUE(events) << events.error().message;
  Walk walk = before_the_wall();
  play_before_the_wall(*events, walk);
  walk.first.exposure = 12;  // it was 3
  const auto press = [&](const char* key) {
    for (const bool is_down : {true, false}) handle(KeyChanged{key, is_down}, on_the_wall, walk);
  };
  press("alt+9");
  expect_place(eye_of(walk), {0, 0, 8.1f});
  EXPECT_EQ(walk.shown.show, Show::light);
  EXPECT_FLOAT_EQ(walk.shown.exposure, 12 * std::sqrt(2.0f));
  press("alt+5");  // there is none
  expect_place(eye_of(walk), {0, 0, 8.1f});
  press("alt+2");
  expect_place(eye_of(walk), {0, 0, 10});
  EXPECT_EQ(walk.shown.show, Show::light_and_colour);
  EXPECT_FLOAT_EQ(walk.shown.exposure, 12);
}

TEST(Bookmarks, HaveTheKeysOfNineDigits) {
  EXPECT_EQ(bookmark_key("ctrl+1")->number, 0u);
  EXPECT_EQ(bookmark_key("alt+9")->number, 8u);
  EXPECT_TRUE(bookmark_key("ctrl+1")->remembers);
  EXPECT_FALSE(bookmark_key("alt+9")->remembers);
  for (const char* other : {"", "1", "ctrl+", "ctrl+0", "ctrl+s", "alt+10", "shift+1"})
    EXPECT_FALSE(bookmark_key(other)) << other;
}

TEST(Walk, DraggingTheLineBetweenTwoBakesMovesIt) {
  Walk walk = before_the_wall();
  const Vec3 eye = eye_of(walk);
  handle(SplitMoved{0.1f}, on_the_wall, walk);
  EXPECT_FALSE(walk.shown.beside) << "there is no second bake";
  walk.shown.beside.emplace();  // the line is at 150 of 300
  drag(Button::left, {153, 50}, {225, 80}, walk);
  EXPECT_FLOAT_EQ(walk.shown.beside->split, 0.75f);
  expect_place(eye_of(walk), eye);
  drag(Button::left, {225, 50}, {900, 80}, walk);
  EXPECT_FLOAT_EQ(walk.shown.beside->split, 1);
  handle(SplitMoved{0.5f}, on_the_wall, walk);
  drag(Button::left, {170, 50}, {225, 80}, walk);  // beside the line: the camera turns
  EXPECT_FLOAT_EQ(walk.shown.beside->split, 0.5f);
  EXPECT_GT(length(eye_of(walk) - eye), 1);
  const Vec3 turned = eye_of(walk);
  handle(BesideChanged{BesideMode::flip}, on_the_wall, walk);
  drag(Button::left, {150, 50}, {225, 80}, walk);  // there is no line
  EXPECT_GT(length(eye_of(walk) - turned), 1);
}

TEST(Play, GoesOnInStepsOfItsOwn) {
  const auto events = parse_play(R"({"frames_per_s": 10, "end": 2, "events": [
    {"at": 0, "key": "w"}, {"at": 1, "key_up": "w"},
    {"at": 1.2, "pointer": [200, 50]}, {"at": 1.2, "press": "right"},
    {"at": 1.5, "pointer": [80, 120]}, {"at": 2, "release": "right"}]})",
                                 "walk.json");
  ASSERT_TRUE(events) << events.error().message;
  EXPECT_EQ(events->events.size(), 6u);
  Walk walk = before_the_wall();
  play_before_the_wall(*events, walk);
  EXPECT_NEAR(eye_of(walk).z, 8, 1e-4f) << "one second at 2 m/s";
  EXPECT_FALSE(walk.dragging);
  expect_place(*on_the_wall(walk.shown, {80, 120}), walk.target);
  EXPECT_GT(length(walk.target), 1);
}

TEST(Play, ChoosesWhatIsShownOfABake) {
  const auto events = parse_play(R"({"end": 1, "events": [
    {"at": 0, "show": "irradiance"}, {"at": 0, "range": [5, 500]}, {"at": 0, "channel": "blue"},
    {"at": 1, "show": "density"}, {"at": 1, "logarithmic_range": [1, 64]}]})",
                                 "walk.json");
  ASSERT_TRUE(events) << events.error().message;
  Walk walk = before_the_wall();
  play_before_the_wall(*events, walk);
  EXPECT_EQ(walk.shown.show, Show::density);
  EXPECT_EQ(walk.shown.channel, Channel::blue);
  EXPECT_EQ(walk.shown.irradiance, (ColorScale{5, 500, false}));
  EXPECT_EQ(walk.shown.density, (ColorScale{1, 64, true}));
  for (uint32_t i = 0; i < kShows.size(); ++i) {
    const auto shows = parse_play(fmt::format(R"({{"end": 0, "events": [
      {{"at": 0, "show": "{}"}}]}})",
                                              kShows[i].name),
                                  "walk.json");
    ASSERT_TRUE(shows) << shows.error().message;
    play_before_the_wall(*shows, walk);
    EXPECT_EQ(walk.shown.show, Show(i));
  }
}

// The list of F1 says the keys of kShows with the same words.
TEST(Walk, KeysOfTheListAreThoseOfWhatIsShown) {
  for (const ShowName& shows : kShows) {
    const bool is_listed = std::any_of(std::begin(kKeys), std::end(kKeys), [&](const KeyHelp& key) {
      return std::string(key.key) == shows.key && std::string(key.does) == shows.words;
    });
    EXPECT_EQ(is_listed, *shows.key != 0) << shows.name;
  }
}

TEST(Play, StandsStillWhileItWaits) {
  const auto events = parse_play(R"({"frames_per_s": 10, "end": 1, "events": [
    {"at": 0.1, "key": "2"}, {"at": 0.1, "wait": "bake"}, {"at": 0.1, "key": "3"},
    {"at": 0.5, "wait": "bake"}]})",
                                 "walk.json");
  ASSERT_TRUE(events) << events.error().message;
  Walk walk = before_the_wall();
  Played played;
  const auto take = [&](const Event& event) { handle(event, on_the_wall, walk); };
  EXPECT_EQ(step(*events, true, take, played), Step::next) << "no event has come";
  EXPECT_EQ(played.frame, 1);
  for (int frame = 0; frame < 2; ++frame) {
    EXPECT_EQ(step(*events, true, take, played), Step::waits);
    EXPECT_EQ(walk.shown.show, Show::light) << "what comes before is played";
  }
  EXPECT_EQ(step(*events, false, take, played), Step::next);
  EXPECT_EQ(walk.shown.show, Show::colour);
  while (played.frame < 5) EXPECT_EQ(step(*events, true, take, played), Step::next);
  EXPECT_EQ(step(*events, true, take, played), Step::waits);
  // Without anything to wait for, a play goes on.
  while (played.frame < 10) EXPECT_EQ(step(*events, false, take, played), Step::next);
  EXPECT_EQ(step(*events, false, take, played), Step::ends);
}

TEST(Play, SaysWhichEventIsWrong) {
  const auto error = [](const std::string& events, const std::string& rest = R"("end": 2)") {
    const auto read = parse_play("{" + rest + R"(, "events": [)" + events + "]}", "walk.json");
    return read ? "no error" : read.error().message;
  };
  const std::string right = R"({"at": 1, "scroll": 1})";
  EXPECT_EQ(error(right), "no error");
  EXPECT_THAT(error(right + R"(, {"at": 0.5, "scroll": 1})"),
              HasSubstr("walk.json, event 2: its time, 0.5, is not from 1 to 2"));
  for (const char* wrong :
       {R"({"at": 1})", R"({"at": 1, "jump": 1})", R"({"at": 1, "press": "fourth"})",
        R"({"at": 1, "key": "hyper"})", R"({"at": 1, "scroll": 1, "key": "w"})",
        R"({"at": 1, "scroll": 1e9})", R"({"at": 1, "show": "depth"})",
        R"({"at": 1, "channel": "alpha"})", R"({"at": 1, "range": [2, 2]})",
        R"({"at": 1, "logarithmic_range": [0, 1]})", R"({"at": 1, "beside": "above"})",
        R"({"at": 1, "split": 2})", R"({"at": 1, "part": "half"})", R"({"at": 1, "bounces": -1})",
        R"({"at": 1, "bounce": 9})"})
    EXPECT_THAT(error(wrong),
                AllOf(HasSubstr("walk.json, event 1: "), HasSubstr("is not an event")));
  for (const char* wrong : {R"({"at": "now", "scroll": 1})", R"({"at": 1, "pointer": [1]})", "7"})
    EXPECT_THAT(error(wrong), HasSubstr("walk.json, event 1: "));
  EXPECT_THAT(error(right, R"("end": 1e9)"), HasSubstr("end from 0 to 3600 seconds"));
  EXPECT_THAT(error(right, R"("end": 2, "frames_per_s": 0)"), HasSubstr("from 1 to 1000"));
  EXPECT_THAT(error(right, R"("frames_per_s": 10)"), HasSubstr("walk.json: "));
  EXPECT_FALSE(parse_play("", "walk.json"));
  EXPECT_FALSE(parse_play("[]", "walk.json"));
}

}  // namespace
}  // namespace luxel::view
