// Clicks, keys and plays in the workshop of hemicube radiosity.
#include "luxel/view/hemicube/hemicube_desk.h"

#include <gtest/gtest.h>

#include "luxel/scene/shapes.h"
#include "luxel/view/hemicube/mesh_test_support.h"

namespace luxel::view {
namespace {

/// A square from (-1, -1, 0) to (1, 1, 0) that is looked at from z = 3, one metre for each of 100
/// pixels in its plane.
struct Desk {
  std::shared_ptr<const LightMesh> mesh;
  Walk walk;
  HemicubeDesk desk;

  Desk() {
    scene::Scene scene;
    scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
    scene::Mesh square;
    scene::add_quad(square, {Vec3{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, 0);
    scene::place(scene, std::move(square), {});
    mesh = testing::mesh_in(scene, 0.3f);
    Frame first;
    first.camera.world_from_camera.row[2][3] = 3;
    first.camera.fov_y_rad = 2 * std::atan(1.0f / 2);
    walk = begin_walk(first, scene::world_bounds(scene), 300, 300,
                      place_seen_in(mesh->in->scene, *mesh->in->tracer, 300, 300));
  }
  bool take(const Event& event) {
    const bool taken = handle_hemicube(event, walk, mesh.get(), desk);
    if (const auto* moved = std::get_if<PointerMoved>(&event)) walk.pointer = moved->to;
    return taken;
  }
  void click(Vec2 at, Vec2 let_go) {
    take(PointerMoved{at});
    take(ButtonChanged{Button::left, true});
    take(PointerMoved{let_go});
    take(ButtonChanged{Button::left, false});
  }
};

TEST(HemicubeDesk, AClickChoosesTheNearestVertexAndADragNone) {
  Desk d;
  d.click({150, 150}, {180, 150});
  EXPECT_FALSE(d.desk.element);
  d.click({150, 150}, {151, 150});
  ASSERT_TRUE(d.desk.element);
  // No vertex is nearer to the middle.
  const auto away = [&](uint32_t v) {
    return length(d.mesh->mesh.points[d.mesh->mesh.point_of[v]] - Vec3{0.01f, 0, 0});
  };
  for (uint32_t v = 0; v < d.mesh->receivers.size(); ++v)
    EXPECT_LE(away(*d.desk.element), away(v) + 1e-6f);
  const auto mark = mark_of(d.desk, d.mesh.get(), d.walk);
  ASSERT_TRUE(mark);
  EXPECT_LT(length(mark->from - Vec2{150, 150}), 25);
  // Beside the square nothing is seen.
  d.click({5, 5}, {5, 5});
  EXPECT_FALSE(d.desk.element);
  EXPECT_FALSE(mark_of(d.desk, d.mesh.get(), d.walk));
  EXPECT_EQ(d.desk.asked, 2u);
}

TEST(HemicubeDesk, KeysAndPlaysChooseWhatIsShown) {
  Desk d;
  for (size_t i = 0; i < kTechniques.size(); ++i) {
    EXPECT_TRUE(d.take(KeyChanged{kTechniques[i].key, true}));
    EXPECT_EQ(d.desk.technique, Technique(i));
  }
  for (size_t i = 0; i < kTechniques.size(); ++i) {
    EXPECT_TRUE(d.take(OwnShown{kTechniques[i].name}));
    EXPECT_EQ(d.desk.technique, Technique(i));
  }
  EXPECT_FALSE(d.take(KeyChanged{"w", true})) << "the walk's";
  for (const auto& [has_report, faces] :
       {std::pair(true, Faces::lit), {false, Faces::lit}, {true, Faces::items}}) {
    EXPECT_TRUE(d.take(KeyChanged{"i", true}));
    EXPECT_EQ(d.desk.has_report, has_report);
    EXPECT_EQ(d.desk.faces, faces);
  }
  EXPECT_TRUE(d.take(SettingChanged{"hemicube", 128}));
  EXPECT_EQ(d.desk.resolution, 128);
  EXPECT_TRUE(d.take(SettingChanged{"pause_at", 0.5}));
  EXPECT_EQ(d.desk.pause_at, 0.5);
  EXPECT_EQ(hemicube_size(3), 4);
  EXPECT_EQ(hemicube_size(-5), 2);
  EXPECT_EQ(hemicube_size(1e9), kMostPixels);
}

TEST(HemicubeDesk, KnowsWhereAPlayStopsFromTheBeginning) {
  const auto pause = [](const std::string& at) {
    return first_pause(*parse_play(
        R"({"end": 1, "events": [{"at": )" + at + R"(, "set": {"pause_at": 0.25}}]})", "p.json"));
  };
  EXPECT_EQ(pause("0"), 0.25);
  EXPECT_EQ(pause("1"), std::nullopt);
}

TEST(HemicubeDesk, SaysWhatIsNotForIt) {
  const auto error = [](const std::string& event) {
    const auto play = parse_play(R"({"end": 1, "events": [{"at": 0, )" + event + "}]}", "p.json");
    if (!play) return play.error().message;
    const Status checked = check_hemicube(*play, "p.json");
    return checked ? std::string() : checked.error().message;
  };
  EXPECT_EQ(error(R"("show": "cads-pixel")"), "");
  EXPECT_EQ(error(R"("set": {"hemicube": 100})"), "");
  EXPECT_EQ(error(R"("overlay": {"lit": true})"), "");
  EXPECT_EQ(error(R"("show": "flat")"), "p.json, at 0 s: hemicube radiosity does not show 'flat'");
  EXPECT_EQ(error(R"("set": {"hemicube": 7})"),
            "p.json, at 0 s: a hemicube has an even number of pixels from 2 to 1024, not 7");
  EXPECT_EQ(error(R"("set": {"eps": 7})"),
            "p.json, at 0 s: there is no setting 'eps'; choose from: hemicube, pause_at");
  EXPECT_EQ(error(R"("overlay": {"links": true})"),
            "p.json, at 0 s: there is no overlay 'links'; choose from: vertex, lit");
  EXPECT_NE(error(R"("select": "chair")"), "");
  EXPECT_EQ(error(R"("tool": "link")"),
            "p.json, at 0 s: hemicube radiosity has no tools; a click chooses a vertex");
  EXPECT_EQ(error(R"("do": "iterate")"), "p.json, at 0 s: hemicube radiosity cannot do 'iterate'");
}

}  // namespace
}  // namespace luxel::view
