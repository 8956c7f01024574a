// Tools of editing, asked of the rays that draw the picture.
#include "luxel/view/edit/tools.h"

#include <gmock/gmock.h>

#include "luxel/scene/digest.h"
#include "luxel/view/edit/pick.h"
#include "luxel/view/model/play.h"
#include "luxel/view/model/projection.h"

namespace luxel::view {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = scene::PunctualLight::Kind;

constexpr int kBenchWidth = 300, kBenchHeight = 200;

/// A square of 2 m that faces +z, in two materials, its middle at the mesh's (5, 0, 0).
scene::Mesh square() {
  scene::Mesh out;
  out.positions = {{4, -1, 0}, {6, -1, 0}, {6, 1, 0}, {4, 1, 0}};
  out.triangles = {{0, 1, 2}, {0, 2, 3}};
  out.triangle_material = {0, 1};
  return out;
}

/// Seen by a camera at (0, 0, 10) that looks along -z: a square "near" around the origin, a square
/// "far" 4 m behind it, and a point lamp at (-2, 1, 0).
struct Bench {
  std::shared_ptr<ReadScene> read = std::make_shared<ReadScene>();
  Walk walk;
  EditTools tools;

  Bench() {
    scene::Scene& scene = read->scene;
    scene.meshes = {square()};
    scene.materials.resize(2);
    scene.materials[0].name = "lower", scene.materials[1].name = "upper";
    scene.instances = {{"near", 0, translation({-5, 0, 0})}, {"far", 0, translation({-5, 0, -4})}};
    scene.lights.resize(1), scene.lights[0].position = {-2, 1, 0};
    read->tracer.emplace(*trace::RayTracer::build(scene));
    tools = begin_tools(read);
    Frame first;
    first.camera.world_from_camera.row[2][3] = 10;
    walk = begin_walk(first, tools.bounds, kBenchWidth, kBenchHeight, seen());
  }

  std::optional<Vec3> place_at(Vec2 pixel) const {
    const trace::Ray ray = ray_through(walk, pixel);
    const trace::Hit hit = visible_now(tools.desk, ray);
    return hit.found() ? std::optional(ray.origin + ray.direction * hit.t) : std::nullopt;
  }
  PlaceSeen seen() const {
    return [this](const Frame&, Vec2 pixel) { return place_at(pixel); };
  }
  void take(const Event& event) {
    if (!handle_edits(event, walk, tools)) handle(event, seen(), walk);
  }
  void key(const char* name) { take(KeyChanged{name, true}), take(KeyChanged{name, false}); }
  void press(Vec2 at) { take(PointerMoved{at}), take(ButtonChanged{Button::left, true}); }
  void release() { take(ButtonChanged{Button::left, false}); }
  void click(Vec3 at) { press(pixel(at)), release(); }
  void drag(Vec2 from, Vec2 to) {
    press(from);
    take(PointerMoved{from * 0.4f + to * 0.6f}), take(PointerMoved{to});
    release();
  }
  void drag(Vec3 from, Vec3 to) { drag(pixel(from), pixel(to)); }
  Vec2 pixel(Vec3 place) const { return *pixel_of(walk, place); }
  /// The reach of a gizmo at the origin [m].
  float reach_m() const { return gizmo_reach(walk) * metres_per_pixel(walk, {}); }
  Mat34 placed(uint32_t instance = 0) const { return tools.desk.now.world_from_object[instance]; }
  Vec3 middle() const { return transform_point(placed(), {5, 0, 0}); }
  const Lamp& lamp(size_t i = 0) const { return tools.desk.now.lamps[i]; }
};

void expect_close(Vec3 a, Vec3 b, float within = 2e-3f) {
  EXPECT_LE(length(a - b), within) << "(" << a.x << ", " << a.y << ", " << a.z << ") for (" << b.x
                                   << ", " << b.y << ", " << b.z << ")";
}

TEST(EditTools, AClickSelectsASurfaceAndThenItsMaterial) {
  Bench b;
  b.click({0.5f, -0.5f, 0});
  EXPECT_EQ(b.tools.selected, (EditSelection{.instance = 0}));
  b.click({0.5f, -0.5f, 0});
  EXPECT_EQ(b.tools.selected, (EditSelection{.instance = 0, .material = 0}));
  b.click({-0.5f, 0.5f, 0});
  EXPECT_EQ(b.tools.selected, (EditSelection{.instance = 0, .material = 1}));
  b.click({-0.5f, 0.5f, 0});
  EXPECT_EQ(b.tools.selected, (EditSelection{.instance = 0}));
  b.click({0, 3, 0});
  EXPECT_EQ(b.tools.selected, EditSelection{});
  b.click({0.5f, -0.5f, 0}), b.key("esc");
  EXPECT_EQ(b.tools.selected, EditSelection{});
  EXPECT_TRUE(b.tools.desk.history.done.empty());
}

TEST(EditTools, KnowTheBoxOfWhatIsSelected) {
  Bench b;
  EXPECT_TRUE(selected_box(b.tools).empty());
  b.click({0.5f, -0.5f, 0});
  do_edit(InstanceMoved{0, translation({-3, 0, 7}) * scaling({1, 2, 1})}, b.tools.desk);
  const Box3 box = selected_box(b.tools);
  EXPECT_EQ(box.lower, (Vec3{1, -2, 7}));
  EXPECT_EQ(box.upper, (Vec3{3, 2, 7}));
  select({.lamp = 0}, b.tools);
  EXPECT_EQ(selected_box(b.tools).centre(), (Vec3{-2, 1, 0}));
}

TEST(EditTools, ADragBesideItTurnsTheViewAndSelectsNothing) {
  Bench b;
  const Mat34 before = b.walk.shown.camera.world_from_camera;
  b.press({150, 30});
  b.take(PointerMoved{{153, 31}});
  EXPECT_EQ(b.walk.shown.camera.world_from_camera, before) << "a hand that shakes";
  b.take(PointerMoved{{180, 31}});
  EXPECT_NE(b.walk.shown.camera.world_from_camera, before);
  b.release();
  EXPECT_EQ(b.tools.selected, EditSelection{});
}

TEST(EditTools, WhatHasMovedIsPickedWhereItIs) {
  Bench b;
  do_edit(InstanceMoved{0, translation({-3, 0, 0})}, b.tools.desk);
  b.click({0.5f, 0.5f, -4});
  EXPECT_EQ(b.tools.selected.instance, 1u) << "through where the other was";
  b.click({2.5f, 0.5f, 0});
  EXPECT_EQ(b.tools.selected.instance, 0u);
  const auto place = b.place_at(b.pixel({2.5f, 0.5f, 0}));
  ASSERT_TRUE(place);
  expect_close(*place, {2.5f, 0.5f, 0});
  // Turned round, it shows its back, which is not seen.
  do_edit(InstanceMoved{0, turned_about({0, 0, 0}, {0, 1, 0}, kPi) * translation({-5, 0, 0})},
          b.tools.desk);
  b.click({0.5f, 0.5f, -4});
  EXPECT_EQ(b.tools.selected.instance, 1u);
  // Mirrored, it has its front where it was.
  do_edit(InstanceMoved{0, scaling({-1, 1, 1}) * translation({-5, 0, 0})}, b.tools.desk);
  b.click({-0.7f, -0.7f, 0});
  EXPECT_EQ(b.tools.selected.instance, 0u);
}

TEST(EditTools, AnArrowMovesAlongItsAxis) {
  Bench b;
  b.click({0.5f, -0.5f, 0});
  const Vec3 grip{0.8f * b.reach_m(), 0, 0};
  b.drag(b.pixel(grip), b.pixel(grip + Vec3{1.5f, 0, 0}) + Vec2{0, 20});
  expect_close(b.middle(), {1.5f, 0, 0}, 0.02f);
  EXPECT_EQ(b.middle().y, 0) << "whatever the pointer does beside the axis";
  EXPECT_EQ(b.tools.desk.history.done.size(), 1u);
  const Vec3 up = b.middle() + Vec3{0, 0.8f * b.reach_m(), 0};
  b.drag(up, up + Vec3{0, -0.7f, 0});
  expect_close(b.middle(), {1.5f, -0.7f, 0}, 0.02f);
  b.key("ctrl+z"), b.key("ctrl+z");
  EXPECT_EQ(b.placed(), b.read->scene.instances[0].world_from_object);
  b.key("ctrl+shift+z");
  expect_close(b.middle(), {1.5f, 0, 0}, 0.02f);
}

TEST(EditTools, APlaneAndTheMiddleFollowThePointer) {
  Bench b;
  b.click({0.5f, -0.5f, 0});
  const Vec3 grip = Vec3{0.37f, 0.37f, 0} * b.reach_m();
  b.drag(grip, grip + Vec3{0.6f, 0.5f, 0});
  expect_close(b.middle(), {0.6f, 0.5f, 0});
  b.drag(b.middle(), {-0.5f, 0.25f, 0});
  expect_close(b.middle(), {-0.5f, 0.25f, 0});
}

TEST(EditTools, CtrlMovesTurnsAndScalesInSteps) {
  Bench b;
  b.click({0.5f, -0.5f, 0});
  EXPECT_EQ(snap_of(b.tools.bounds).move_m, 0.02f);  // of a diagonal of 4.9 m
  Box3 hall;
  hall.extend({0, 0, 0}), hall.extend({30, 0, 0});
  EXPECT_FLOAT_EQ(snap_of(hall).move_m, 0.2f);
  b.take(KeyChanged{"ctrl", true});
  const Vec3 grip{0.8f * b.reach_m(), 0, 0};
  b.drag(grip, grip + Vec3{0.328f, 0, 0});
  expect_close(b.middle(), {0.32f, 0, 0}, 1e-5f);
  b.key("r");
  const auto at = [&](float degrees) {
    const float a = degrees * kPi / 180;
    return b.middle() + Vec3{std::cos(a), std::sin(a), 0} * b.reach_m();
  };
  b.drag(at(20), at(20 + 40));
  expect_close(placement_of(b.tools).angles_deg, {0, 0, 45}, 1e-3f);
  b.key("t");
  b.drag(b.middle(), b.middle());  // nothing
  const Vec3 along = column(turn_of(b.placed()), 0) * b.reach_m();
  b.drag(b.middle() + along, b.middle() + along * 1.57f);
  expect_close(placement_of(b.tools).scale, {1.6f, 1, 1}, 1e-4f);
}

TEST(EditTools, ARingTurns) {
  Bench b;
  b.click({0.5f, -0.5f, 0}), b.key("r");
  const auto at = [&](float degrees) {
    const float a = degrees * kPi / 180;
    return Vec3{std::cos(a), std::sin(a), 0} * b.reach_m();
  };
  b.drag(at(20), at(20 + 33));
  expect_close(placement_of(b.tools).angles_deg, {0, 0, 33}, 0.01f);
  expect_close(b.middle(), {});
  b.drag(at(170), at(190));  // where atan2 jumps
  expect_close(placement_of(b.tools).angles_deg, {0, 0, 53}, 0.01f);
  b.key("ctrl+z"), b.key("ctrl+z");
  EXPECT_EQ(b.placed(), b.read->scene.instances[0].world_from_object);
}

// The ring about y is seen from its edge, as a line: its near side goes with the pointer.
TEST(EditTools, ARingFromItsEdgeTurns) {
  Bench b;
  b.click({0.5f, -0.5f, 0}), b.key("r");
  const Vec2 from = b.pixel({0.3f, 0, 0});
  b.drag(from, from + Vec2{5, 0});
  const float turned = placement_of(b.tools).angles_deg.y;
  const Vec3 taken{0.3f, 0, std::sqrt(b.reach_m() * b.reach_m() - 0.09f)};
  const Vec3 now = transform_point(turned_about({}, {0, 1, 0}, turned * kPi / 180), taken);
  EXPECT_NEAR(b.pixel(now).x - b.pixel(taken).x, 5, 0.5f);
}

TEST(EditTools, BoxesScale) {
  Bench b;
  b.click({0.5f, -0.5f, 0}), b.key("t");
  const Vec3 grip{0, 0.9f * b.reach_m(), 0};
  b.drag(grip, grip * 2);
  expect_close(placement_of(b.tools).scale, {1, 2, 1});
  expect_close(b.middle(), {});
  b.drag(b.pixel({}), b.pixel({}) + Vec2{60, -40});
  expect_close(placement_of(b.tools).scale, {2, 4, 2});
}

TEST(EditTools, AGizmoHasItsSizeWhereverItStands) {
  Bench b;
  for (const float z : {0.0f, -20.0f}) {
    const Gizmo gizmo{Tool::move, {0, 0, z}, {}};
    EXPECT_EQ(grip_at(gizmo, b.walk, b.pixel(gizmo.centre) + Vec2{25, 0}), Grip::x);
    EXPECT_EQ(grip_at(gizmo, b.walk, b.pixel(gizmo.centre) + Vec2{60, 0}), std::nullopt);
    float right = 0;
    for (const Mark& mark : marks_of(gizmo, std::nullopt, b.walk))
      right = std::max(right, mark.to.x - b.pixel(gizmo.centre).x);
    EXPECT_NEAR(right, gizmo_reach(b.walk), 0.5f);
  }
  const Gizmo behind{Tool::turn, {0, 0, 12}, {}};
  EXPECT_TRUE(marks_of(behind, std::nullopt, b.walk).empty());
  EXPECT_FALSE(grip_at(behind, b.walk, {150, 100}));
}

TEST(EditTools, LampsAreDraggedTurnedAndDeleted) {
  Bench b;
  b.drag({-2, 1, 0}, {1, 2, 0});
  EXPECT_EQ(b.tools.selected, (EditSelection{.lamp = 0}));
  expect_close(b.lamp().light.position, {1, 2, 0});
  EXPECT_EQ(b.tools.desk.history.done.size(), 1u);
  const Vec3 grip = Vec3{1, 2, 0} + Vec3{0.8f * b.reach_m(), 0, 0};
  b.drag(grip, grip - Vec3{2, 0, 0});
  expect_close(b.lamp().light.position, {-1, 2, 0}, 0.02f);
  LampAdded spot{Kind::spot, {}};
  spot.change.to = DVec3{};
  add_lamp(spot, b.tools);
  b.key("r");
  const Vec3 corner = normalize(Vec3{1, 1, 0}) * b.reach_m();
  b.drag(-corner, Vec3{corner.x, -corner.y, 0});  // a quarter about z
  expect_close(b.lamp(1).light.direction, {1, 0, 0}, 0.02f);
  EXPECT_EQ(b.lamp(1).light.position, (Vec3{0, 0, 0}));
  b.key("delete");
  EXPECT_TRUE(b.lamp(1).is_deleted);
  EXPECT_EQ(b.tools.selected, EditSelection{});
  for (const Mark& mark : marks_of(b.tools, b.walk))
    EXPECT_GT(length(mark.from - b.pixel({})), 10) << "no mark of what is deleted";
  while (!b.tools.desk.history.done.empty()) b.key("ctrl+z");
  EXPECT_THAT(scene::difference(scene::digests_of(b.read->scene),
                                scene::digests_of(edited(b.read->scene, b.tools.desk.now))),
              IsEmpty());
}

TEST(EditTools, EscLetsGoOfWhatIsDragged) {
  Bench b;
  b.press(b.pixel({-2, 1, 0}));
  b.take(PointerMoved{b.pixel({0, 2, 0})});
  expect_close(b.lamp().light.position, {0, 2, 0});
  b.key("esc");
  EXPECT_EQ(b.lamp().light.position, (Vec3{-2, 1, 0}));
  b.take(PointerMoved{b.pixel({1, 2, 0})}), b.release();
  EXPECT_EQ(b.lamp().light.position, (Vec3{-2, 1, 0}));
  EXPECT_EQ(b.tools.selected, (EditSelection{.lamp = 0})) << "which the next one lets go of";
}

TEST(EditTools, PlaysEdits) {
  Bench b;
  const auto events = parse_play(R"({"end": 1, "events": [
    {"at": 0, "select": "far"},
    {"at": 0, "instance": "far", "to": [1, 2, 3], "angles_deg": [0, 90, 0], "scale": [2, 1, 1]},
    {"at": 0, "instance": 0, "to": [0, 0, 1]},
    {"at": 0, "material": "lower", "reflectance": [0.5, 0.25, 0]},
    {"at": 0, "material": "upper", "radiance": [7, 0, 0]},
    {"at": 0, "lamp": 0, "intensity": [4, 5, 6], "on": false},
    {"at": 0, "new_lamp": "directional", "sun": "90,30", "disc_deg": 2},
    {"at": 0, "new_lamp": "spot", "cone_deg": 20, "inner_cone_deg": 10},
    {"at": 0, "lamp": 2, "deleted": true},
    {"at": 0, "select_lamp": 1}]})",
                                 "edits.json");
  ASSERT_TRUE(events) << events.error().message;
  play(
      *events, [&](const Event& event) { b.take(event); }, [](double) {});
  EXPECT_THAT(b.tools.message, IsEmpty());
  expect_close(transform_point(b.placed(1), {5, 0, 0}), {1, 2, 3});
  expect_close(column(b.placed(1), 0), {0, 0, -2});  // x goes to -z, twice as long
  expect_close(b.middle(), {0, 0, 1});
  EXPECT_EQ(b.tools.desk.now.materials[0].base_color, (Rgb{0.5f, 0.25f, 0}));
  EXPECT_EQ(b.tools.desk.now.materials[1].emission, (Rgb{7, 0, 0}));
  EXPECT_FALSE(b.lamp(0).is_on);
  EXPECT_EQ(b.lamp(0).light.intensity, (Rgb{4, 5, 6}));
  // The sun stands in the east, 30 degrees high.
  expect_close(b.lamp(1).light.direction, {-std::sqrt(0.75f), -0.5f, 0});
  EXPECT_NEAR(b.lamp(1).light.angular_radius_rad, kPi / 180, 1e-6f);
  EXPECT_NEAR(b.lamp(2).light.outer_cone_rad, kPi / 9, 1e-6f);
  EXPECT_TRUE(b.lamp(2).is_deleted);
  EXPECT_EQ(b.tools.selected, (EditSelection{.lamp = 1}));
}

TEST(EditTools, SaysWhatIsNotThere) {
  const auto said = [](const std::string& event) {
    Bench b;
    const auto play = parse_play(R"({"end": 0, "events": [)" + event + "]}", "edits.json");
    if (!play) return play.error().message;
    b.take(play->events[0].event);
    EXPECT_TRUE(b.tools.desk.history.done.empty());
    return b.tools.message;
  };
  EXPECT_THAT(said(R"({"at": 0, "select": "chair"})"), HasSubstr("nothing of the name 'chair'"));
  EXPECT_THAT(said(R"({"at": 0, "instance": 2, "to": [0, 0, 0]})"), HasSubstr("the name '2'"));
  EXPECT_THAT(said(R"({"at": 0, "lamp": 1, "on": true})"), HasSubstr("there is no lamp 1"));
  EXPECT_THAT(said(R"({"at": 0, "material": "wood", "reflectance": [0, 0, 0]})"),
              HasSubstr("no material 'wood'"));
  for (const char* wrong :
       {R"({"at": 0, "instance": "near", "size": 3})", R"({"at": 0, "lamp": 0, "sun": "noon"})",
        R"({"at": 0, "material": "lower", "reflectance": [2, 0, 0]})",
        R"({"at": 0, "lamp": 0, "deleted": false})", R"({"at": 0, "lamp": 0, "cone_deg": 100})"})
    EXPECT_THAT(said(wrong), HasSubstr("is not an event")) << wrong;
}

// A turn of 90 degrees about y takes x to -z; typed numbers come back as they were typed.
TEST(Placement, NumbersComeBackAsTheyWereTyped) {
  const Vec3 middle{5, 0, 0};
  const Mat34 from = translation({-5, 1, 0}) * scaling({1, 3, 1});
  Placement to = placement_of(from, middle);
  expect_close(to.place, {0, 1, 0});
  expect_close(to.scale, {1, 3, 1});
  to.angles_deg = {0, 90, 0};
  expect_close(column(placed(from, middle, to), 0), {0, 0, -1});
  for (const Vec3 angles : {Vec3{30, 40, 50}, Vec3{-80, 170, -10}, Vec3{0, -90, 0}, Vec3{89, 1, 2}})
    for (const float mirror : {1.0f, -1.0f}) {
      to = {{1, 2, 3}, angles, {mirror * 2, 0.5f, 1}};
      const Mat34 m = placed(from, middle, to);
      const Placement back = placement_of(m, middle);
      expect_close(back.place, to.place, 1e-5f);
      expect_close(back.angles_deg, to.angles_deg, 1e-2f);
      expect_close(back.scale, to.scale, 1e-5f);
      EXPECT_EQ(placed(m, middle, back), m) << "bit by bit";
    }
}

TEST(Placement, ScalesAlongTheAxesOfTheObject) {
  const Vec3 middle{5, 0, 0};
  const Mat34 turned = turned_about({}, {0, 1, 0}, kPi / 4);
  Placement to = placement_of(turned, middle);
  to.scale.x = 2;
  const Mat34 m = placed(turned, middle, to);
  expect_close(column(m, 0), column(turned, 0) * 2);
  expect_close(column(m, 2), column(turned, 2));
  expect_close(transform_point(m, middle), transform_point(turned, middle));
}

// Single precision has steps of 1 / 16 m at such places.
TEST(EditTools, PlacesOfAPlayAreThoseOfTheFile) {
  Bench b;
  b.read->scene.origin = {1e6, 0, -2e6};
  const auto events = parse_play(R"({"end": 0, "events": [
    {"at": 0, "instance": "near", "to": [1000001.01, 2, -1999997.03]},
    {"at": 0, "lamp": 0, "to": [999998.99, 1, -2000000]},
    {"at": 0, "new_lamp": "point", "to": [1000000.03, 0, -2000000]}]})",
                                 "edits.json");
  ASSERT_TRUE(events) << events.error().message;
  for (const TimedEvent& timed : events->events) b.take(timed.event);
  expect_close(b.middle(), {1.01f, 2, 2.97f}, 1e-6f);
  expect_close(b.lamp().light.position, {-1.01f, 1, 0}, 1e-6f);
  expect_close(b.lamp(1).light.position, {0.03f, 0, 0}, 1e-6f);
}

}  // namespace
}  // namespace luxel::view
