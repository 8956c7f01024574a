// Lamps that are taken hold of, asked of the rays that draw the picture.
#include "luxel/view/relight/lamp_desk.h"

#include <gmock/gmock.h>

#include "luxel/trace/camera_rays.h"
#include "luxel/view/model/play.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Kind = scene::PunctualLight::Kind;

constexpr int kDeskWidth = 300, kDeskHeight = 200;

const PlaceSeen kNowhere = [](const Frame&, Vec2) { return std::nullopt; };

/// A camera at (0, 0, 10) that looks along -z, and lamps: a point in the middle, a spot to the
/// right that looks down, a sun from above.
struct Table {
  Walk walk;
  LampDesk desk;

  Table() {
    Box3 bounds;
    bounds.extend({-3, -3, -3}), bounds.extend({3, 3, 3});
    Frame first;
    first.camera.world_from_camera.row[2][3] = 10;
    walk = begin_walk(first, bounds, kDeskWidth, kDeskHeight, kNowhere);
    Lamps lamps;
    lamps.lamps.resize(3);
    lamps.lamps[1].light.kind = Kind::spot, lamps.lamps[1].light.position = {2, 0, 1};
    lamps.lamps[2].light.kind = Kind::directional;
    lamps.glows = {{"glass", {1, 1, 1}}};
    desk = begin_desk(lamps, bounds);
  }

  void take(const Event& event) {
    if (!handle_lamps(event, walk, desk)) handle(event, kNowhere, walk);
  }
  void key(const char* name) {
    take(KeyChanged{name, true});
    take(KeyChanged{name, false});
  }
  void drag(Vec2 from, Vec2 to) {
    take(PointerMoved{from}), take(ButtonChanged{Button::left, true});
    take(PointerMoved{to * 0.5f + from * 0.5f}), take(PointerMoved{to});
    take(ButtonChanged{Button::left, false});
  }
  Vec2 pixel(Vec3 place) const { return *pixel_of(walk, place); }
  scene::PunctualLight& light(size_t i) { return desk.lamps.lamps[i].light; }
};

void expect_near(Vec3 a, Vec3 b) {
  EXPECT_LE(length(a - b), 1e-4f) << "(" << a.x << ", " << a.y << ", " << a.z << ") for (" << b.x
                                  << ", " << b.y << ", " << b.z << ")";
}

TEST(LampDesk, KnowsWhetherAnythingShines) {
  Lamps lamps = Table().desk.lamps;
  EXPECT_TRUE(has_light(lamps));
  for (Lamp& lamp : lamps.lamps) lamp.is_on = false;
  EXPECT_TRUE(has_light(lamps)) << "glass glows";
  lamps.glows[0].radiance = {};
  EXPECT_FALSE(has_light(lamps));
  lamps.background = {0, 0, 1};
  EXPECT_TRUE(has_light(lamps));
}

TEST(LampDesk, PixelsAreThoseOfTheRays) {
  Table t;
  for (const float height_m : {0.0f, 4.0f}) {
    t.walk.shown.camera.orthographic_height_m = height_m;
    const trace::Ray ray =
        trace::CameraRays(t.walk.shown.camera, kDeskWidth, kDeskHeight).through(70, 130);
    const Vec2 pixel = t.pixel(ray.origin + ray.direction * 3);
    EXPECT_NEAR(pixel.x, 70, 1e-3f);
    EXPECT_NEAR(pixel.y, 130, 1e-3f);
  }
  EXPECT_FALSE(pixel_of(t.walk, {0, 0, 11})) << "behind the eye";
}

TEST(LampDesk, ALampFollowsThePointer) {
  Table t;
  const Vec3 to{1, 0.5f, 0};  // as far from the eye's plane as it was
  t.drag(t.pixel({0, 0, 0}) + Vec2{5, 4}, t.pixel(to) + Vec2{5, 4});
  expect_near(t.light(0).position, to);
  EXPECT_EQ(t.desk.selected, 0u);
  EXPECT_EQ(t.desk.changes, 2u);
  EXPECT_EQ(column(t.walk.shown.camera.world_from_camera, 3), (Vec3{0, 0, 10})) << "no orbit";
  const Vec2 beside = t.pixel(to) + Vec2{60, 50};
  t.drag(beside, beside + Vec2{30, 0});
  expect_near(t.light(0).position, to);
  EXPECT_GT(length(column(t.walk.shown.camera.world_from_camera, 3) - Vec3{0, 0, 10}), 1);
}

TEST(LampDesk, AnAxisHoldsIt) {
  Table t;
  t.key("y");
  t.drag(t.pixel({2, 0, 1}), t.pixel({1, 1.5f, 1}));
  EXPECT_EQ(t.light(1).position.x, 2);
  EXPECT_NEAR(t.light(1).position.y, 1.5f, 0.02f);
  EXPECT_EQ(t.light(1).position.z, 1);
  t.key("z");
  EXPECT_EQ(t.desk.axis, 2);
  // Towards the camera a place moves away from the middle of the picture.
  const Vec3 from = t.light(1).position;
  t.drag(t.pixel(from), t.pixel(from + Vec3{0, 0, 2}));
  EXPECT_NEAR(t.light(1).position.z, 3, 1e-3f);
  t.key("z");
  EXPECT_FALSE(t.desk.axis);
}

TEST(LampDesk, SunsAndSpotsTurn) {
  Table t;
  const Handle sun{2, false}, turn{1, true};
  const Vec3 from = place_of(sun, t.desk);
  t.drag(t.pixel(from), t.pixel({from.y, 0, 0}));
  expect_near(t.light(2).direction, {-1, 0, 0});
  t.drag(t.pixel({2, 0, 1}), t.pixel({2, 0, 1}));  // selected: its direction can be taken
  const Vec3 end = place_of(turn, t.desk);
  t.drag(t.pixel(end), t.pixel({2 + 1.3f, 0, 1}));
  expect_near(t.light(1).direction, {1, 0, 0});
  expect_near(t.light(1).position, {2, 0, 1});
}

TEST(LampDesk, MarksStandWhereLampsAreSeen) {
  Table t;
  t.desk.selected = 0;
  const std::vector<Mark> marks = marks_of(t.desk, t.walk);
  const auto has_disc_at = [&](Vec2 pixel) {
    return std::any_of(marks.begin(), marks.end(), [&](const Mark& mark) {
      return mark.from == mark.to && length(mark.from - pixel) < 1e-3f;
    });
  };
  EXPECT_TRUE(has_disc_at(t.pixel({0, 0, 0})));
  EXPECT_TRUE(has_disc_at(t.pixel({2, 0, 1})));
  EXPECT_TRUE(has_disc_at(t.pixel(place_of({2, false}, t.desk))));
  t.key("m");
  EXPECT_TRUE(marks_of(t.desk, t.walk).empty());
  t.drag(t.pixel({0, 0, 0}), {0, 0});
  EXPECT_EQ(t.light(0).position, (Vec3{})) << "what is not seen is not taken";
}

TEST(LampDesk, PlaysLamps) {
  Table t;
  const auto events = parse_play(R"({"end": 2, "events": [
    {"at": 0, "lamp": 0, "to": [1, 2, 3], "intensity": [4, 5, 6]},
    {"at": 1, "lamp": 1, "on": false}, {"at": 1, "lamp": 2, "direction": [2, 0, 0]},
    {"at": 1, "new_lamp": "spot", "to": [0, 1, 0]}, {"at": 1.5, "lamp": 3, "intensity": [7, 7, 7]},
    {"at": 2, "material": "glass", "radiance": [0, 0, 9]}]})",
                                 "lamps.json");
  ASSERT_TRUE(events) << events.error().message;
  ASSERT_TRUE(check_lamps(*events, t.desk.lamps, "lamps.json"));
  play(
      *events, [&](const Event& event) { t.take(event); },
      [&](double seconds) { pass(seconds, t.walk); });
  EXPECT_EQ(t.light(0).position, (Vec3{1, 2, 3}));
  EXPECT_EQ(t.light(0).intensity, (Rgb{4, 5, 6}));
  EXPECT_EQ(t.light(2).direction, (Vec3{1, 0, 0}));
  EXPECT_EQ(t.light(3).kind, Kind::spot);
  EXPECT_EQ(t.light(3).position, (Vec3{0, 1, 0}));
  EXPECT_EQ(shining(t.desk.lamps).size(), 3u);
  EXPECT_EQ(shining(t.desk.lamps)[2].intensity, (Rgb{7, 7, 7}));
  EXPECT_EQ(glowing(t.desk.lamps)[0], (Rgb{0, 0, 9}));
}

// Single precision has steps of 1 / 16 m at such places.
TEST(LampDesk, PlacesOfAPlayAreThoseOfTheFile) {
  Table t;
  t.desk.origin = {1e6, 0, -2e6};
  const auto events = parse_play(R"({"end": 1, "events": [
    {"at": 0, "lamp": 0, "to": [1000001.01, 2, -1999997.03]},
    {"at": 1, "new_lamp": "point", "to": [999998.99, 1, -2000000]}]})",
                                 "lamps.json");
  ASSERT_TRUE(events) << events.error().message;
  play(
      *events, [&](const Event& event) { t.take(event); },
      [&](double seconds) { pass(seconds, t.walk); });
  EXPECT_LE(length(t.light(0).position - Vec3{1.01f, 2, 2.97f}), 1e-6f);
  EXPECT_LE(length(t.light(3).position - Vec3{-1.01f, 1, 0}), 1e-6f);
}

TEST(LampDesk, SaysWhatOfAPlayIsWrong) {
  const auto error = [](const std::string& event) {
    const auto play = parse_play(R"({"end": 1, "events": [)" + event + "]}", "lamps.json");
    if (!play) return play.error().message;
    const Status checked = check_lamps(*play, Table().desk.lamps, "lamps.json");
    return checked ? "no error" : checked.error().message;
  };
  EXPECT_EQ(error(R"({"at": 1, "lamp": 2, "on": true})"), "no error");
  EXPECT_THAT(error(R"({"at": 1, "lamp": 3, "on": true})"),
              HasSubstr("lamps.json, at 1 s: there is no lamp 3; there are 3"));
  EXPECT_THAT(error(R"({"at": 1, "material": "wood", "radiance": [1, 1, 1]})"),
              HasSubstr("no material 'wood'"));
  EXPECT_THAT(error(R"({"at": 1, "select": "box"})"), HasSubstr("open the scene itself"));
  const auto of_a_bake = parse_play(R"({"end": 1, "events": [{"at": 0, "key": "w"},
    {"at": 1, "lamp": 0, "on": true}]})",
                                    "lamps.json");
  ASSERT_TRUE(of_a_bake);
  const Status refused = check_no_lamps(*of_a_bake, "lamps.json");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              AllOf(HasSubstr("lamps.json, at 1 s: "), HasSubstr("a finished bake")));
  for (const char* wrong :
       {R"({"at": 1, "lamp": 0, "colour": [1, 1, 1]})",
        R"({"at": 1, "lamp": 0, "to": [1, 1e30, 1]})",
        R"({"at": 1, "lamp": 0, "direction": [0, 0, 0]})", R"({"at": 1, "new_lamp": "candle"})",
        R"({"at": 1, "lamp": 0, "intensity": [1, -1, 1]})",
        R"({"at": 1, "material": "glass", "radiance": [1, 1, -1]})"})
    EXPECT_THAT(error(wrong), HasSubstr("is not an event")) << wrong;
}

// Brighter by as much as its glow is; a material that did not glow has its glow.
TEST(Lamps, EmissionFollowsTheGlow) {
  Lamps baked, now;
  baked.glows = {{"lamp", {2, 2, 0}}, {"wall", {}}};
  now.glows = {{"lamp", {4, 1, 3}}, {"wall", {0, 1, 0}}};
  scene::Material lamp, wall, other;
  lamp.name = "lamp", lamp.emission = {10, 10, 0};
  wall.name = "wall", other.emission = {5, 5, 5};
  EXPECT_EQ(emission_now(lamp, now, baked), (Rgb{20, 5, 3}));
  EXPECT_EQ(emission_now(wall, now, baked), (Rgb{0, 1, 0}));
  EXPECT_EQ(emission_now(other, now, baked), (Rgb{5, 5, 5}));
  now.glows[0].is_on = false;
  EXPECT_EQ(emission_now(lamp, now, baked), (Rgb{}));
}

}  // namespace
}  // namespace luxel::view
