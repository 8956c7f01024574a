// The camera goes round what it looks at; parts of the light are chosen by keys and by events.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "luxel/view/model/play.h"
#include "luxel/view/model/walk.h"

namespace luxel::view {
namespace {

/// From (0, 1, 10) along -z; what is looked at is the origin's height at z = 4.
Walk before_a_post() {
  Frame first;
  first.camera.world_from_camera = translation({0, 1, 10});
  Box3 bounds;
  bounds.extend({-1, 0, 3}), bounds.extend({1, 2, 5});
  return begin_walk(first, bounds, 300, 200, [](const Frame&, Vec2) {
    return std::optional(Vec3{0, 1, 4});
  });
}

void expect_eye(const scene::Camera& camera, Vec3 place) {
  const Vec3 eye = column(camera.world_from_camera, 3);
  EXPECT_LE(length(eye - place), 1e-4f) << eye.x << " " << eye.y << " " << eye.z;
  // It looks at the post: along its own -z.
  const Vec3 ahead = normalize(Vec3{0, 1, 4} - eye);
  EXPECT_LE(length(ahead + column(camera.world_from_camera, 2)), 1e-4f);
}

void press_key(const std::string& key, Walk& walk) {
  const PlaceSeen nowhere = [](const Frame&, Vec2) { return std::nullopt; };
  for (const bool is_down : {true, false}) handle(KeyChanged{key, is_down}, nowhere, walk);
}

TEST(Turn, ComesRoundOnceIn20Seconds) {
  Walk walk = before_a_post();
  pass(5, walk);
  expect_eye(walk.shown.camera, {0, 1, 10});
  press_key("o", walk);
  pass(5, walk);  // a quarter, counter-clockwise from above
  expect_eye(walk.shown.camera, {6, 1, 4});
  pass(2.5, walk);
  expect_eye(walk.shown.camera, {6 * std::sqrt(0.5f), 1, 4 - 6 * std::sqrt(0.5f)});
  press_key("o", walk);
  pass(5, walk);
  expect_eye(walk.shown.camera, {6 * std::sqrt(0.5f), 1, 4 - 6 * std::sqrt(0.5f)});
}

TEST(Turn, HasSoManyPictures) {
  const Walk walk = before_a_post();
  const std::array<Vec3, 4> eyes{Vec3{0, 1, 10}, {6, 1, 4}, {0, 1, -2}, {-6, 1, 4}};
  for (int k = 0; k < 4; ++k) expect_eye(turned_camera(walk, k, 4), eyes[size_t(k)]);
}

TEST(Parts, AreChosenByKeys) {
  Walk walk = before_a_post();
  const auto after = [&](const char* key) { return press_key(key, walk), walk.shown.light; };
  EXPECT_EQ(after("i"), (LightShown{0, 0})) << "direct";
  EXPECT_EQ(after("i"), (LightShown{1, std::nullopt})) << "indirect";
  EXPECT_TRUE(after("i").is_all());
  EXPECT_EQ(after(","), (LightShown{0, kMostBounces}));
  EXPECT_EQ(after(","), (LightShown{0, kMostBounces - 1}));
  EXPECT_EQ(after("."), (LightShown{0, kMostBounces}));
  EXPECT_TRUE(after(".").is_all());
  walk.shown.light = {0, 0};
  EXPECT_EQ(after(","), (LightShown{0, 0})) << "there is no less";
  EXPECT_EQ(after("."), (LightShown{0, 1}));
}

TEST(Parts, AreChosenByEvents) {
  const auto light = [](const std::string& event) {
    const auto events = parse_play(R"({"end": 0, "events": [{"at": 0, )" + event + "}]}", "p.json");
    EXPECT_TRUE(events) << event;
    return events ? std::get<PartChanged>(events->events.front().event).light : LightShown{};
  };
  EXPECT_EQ(light(R"("part": "direct")"), (LightShown{0, 0}));
  EXPECT_EQ(light(R"("part": "indirect")"), (LightShown{1, std::nullopt}));
  EXPECT_EQ(light(R"("bounces": 3)"), (LightShown{0, 3}));
  EXPECT_EQ(light(R"("bounce": 3)"), (LightShown{3, 3}));
  EXPECT_TRUE(light(R"("part": "all")").is_all());
}

}  // namespace
}  // namespace luxel::view
