#include "luxel/pipeline/bake/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/scene/place_camera.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Room {
  scene::Scene scene = scene::cornell_box();
  trace::RayTracer tracer = *trace::RayTracer::build(scene);
  Result<scene::Camera> camera(const CameraChoice& choice) const {
    return choose_camera(choice, scene, tracer, "box.glb");
  }
};

TEST(ChooseCamera, LooksFromTheEyeAtThePlace) {
  // Its axes are unit, at right angles and right-handed; -z goes to the place, x stays level.
  const Room room;
  for (const Vec3 look_at : {Vec3{1, 2, 8}, {4, 2, -1}, {1, -7, 3}, {1, 9, 3}, {0, 0, 0}}) {
    const Vec3 eye{1, 2, 3};
    CameraChoice choice;
    choice.eye = to_double(eye), choice.look_at = to_double(look_at), choice.fov_deg = 60;
    const auto camera = room.camera(choice);
    ASSERT_TRUE(camera);
    const Mat34& pose = camera->world_from_camera;
    const Vec3 x = column(pose, 0), y = column(pose, 1), z = column(pose, 2);
    // Normalising rounds to 6e-8, a few times.
    EXPECT_LT(length(-z - normalize(look_at - eye)), 1e-6f);
    EXPECT_LT(length(cross(x, y) - z), 1e-6f);
    EXPECT_NEAR(length(x), 1, 1e-6f);
    EXPECT_NEAR(dot(x, y), 0, 1e-6f);
    EXPECT_NEAR(x.y, 0, 1e-6f);
    EXPECT_GE(y.y, -1e-6f);
    EXPECT_EQ(column(pose, 3), eye);
    EXPECT_FLOAT_EQ(camera->fov_y_rad, kPi / 3);
  }
}

TEST(ChooseCamera, TakesTheScenesByName) {
  Room room;
  room.scene.cameras.push_back(room.scene.cameras[0]);
  room.scene.cameras[1].name = "door", room.scene.cameras[1].fov_y_rad = 1;
  CameraChoice choice;
  EXPECT_EQ(room.camera(choice)->name, "published");  // the first
  choice.name = "door";
  EXPECT_EQ(room.camera(choice)->fov_y_rad, 1);
  choice.name = "window";
  EXPECT_THAT(room.camera(choice).error().message,
              HasSubstr("--camera window is not in box.glb; its cameras: published, door"));
  room.scene.cameras.clear();
  EXPECT_THAT(room.camera(choice).error().message, HasSubstr("its cameras: none"));
  choice.name.clear();
  EXPECT_TRUE(room.camera(choice));  // fitted
  choice.eye = choice.look_at;
  EXPECT_THAT(room.camera(choice).error().message, HasSubstr("the same point"));
}

// The words come first; --camera takes a camera that is called like one of them.
TEST(ChooseCamera, TakesAViewByItsWordOrACameraByItsName) {
  Room room;
  room.scene.cameras[0].name = "top";
  const auto view = [&](const char* word) {
    CameraChoice choice;
    choice.view = word;
    return room.camera(choice);
  };
  for (const char* word : {"front", "top"}) EXPECT_GT(view(word)->orthographic_height_m, 0) << word;
  for (const char* word : {"interior", "exterior"}) EXPECT_EQ(view(word)->name, "fitted") << word;
  CameraChoice by_name;
  by_name.name = "top";
  EXPECT_EQ(room.camera(by_name)->orthographic_height_m, 0);
  room.scene.cameras[0].name = "door";
  EXPECT_EQ(view("door")->name, "door");
  EXPECT_THAT(view("window").error().message,
              HasSubstr("--view window is neither interior, exterior, front or top nor a camera of "
                        "box.glb; its cameras: door"));
}

/// A room of 5 x 3 x 5 m whose floor has its corner at the origin, and a camera in it.
Room room_of_5_m(Vec3 eye, Vec3 target) {
  scene::Scene scene;
  scene::add_material(scene, "wall", {0.5f, 0.5f, 0.5f});
  scene::Mesh walls;
  scene::add_box(walls, {0, 0, 0}, {5, 3, 5}, 0);
  for (auto& [a, b, c] : walls.triangles) std::swap(b, c);
  scene::place(scene, std::move(walls));
  scene::place_camera(scene, "file's", eye, target, 0.8f);
  return {std::move(scene)};
}

// Only where nobody asked for it: a camera in a corner, in front of a wall, or beside the room.
TEST(ChooseCamera, LeavesAFilesCameraThatShowsNothing) {
  const auto chosen = [](const Room& room, const CameraChoice& choice = {}) {
    std::vector<std::string> said;
    const auto camera = choose_camera(choice, room.scene, room.tracer, "room.glb", &said);
    EXPECT_EQ(said.empty(), camera->name == "file's");
    return said.empty() ? "" : said[0];
  };
  EXPECT_THAT(chosen(room_of_5_m({2.5f, 1.5f, 0.4f}, {2.5f, 1.5f, 0})),
              AllOf(HasSubstr("looks at a wall 0.4 m away"), HasSubstr("--view file's")));
  EXPECT_THAT(chosen(room_of_5_m({2, 1, -1}, {2, 1, -5})), HasSubstr("shows no surface"));
  EXPECT_EQ(chosen(room_of_5_m({2.5f, 1.5f, 1.2f}, {2.5f, 1.5f, 0})), "");
  EXPECT_EQ(chosen(room_of_5_m({0.4f, 1.5f, 0.4f}, {5, 1, 5})), "");
  EXPECT_EQ(chosen(room_of_5_m({2.5f, 1.5f, 0.4f}, {2.5f, 1.5f, 0}), {.view = "file's"}), "");
}

// A camera close to a small thing is a camera of that thing.
TEST(ChooseCamera, KeepsOneThatIsCloseToASmallThing) {
  Room room = room_of_5_m({2.5f, 1, 2.9f}, {2.5f, 1, 2.5f});
  scene::Mesh cup = scene::sphere("cup", 0.25f, 16, 8, 0);
  scene::place(room.scene, std::move(cup), translation({2.5f, 1, 2.5f}));
  room.tracer = *trace::RayTracer::build(room.scene);
  EXPECT_EQ(room.camera({})->name, "file's");
}

// Backs of one-sided walls are invisible: there is nothing to see from outside of a flat scene's.
TEST(ChooseCamera, LeavesOneThatSeesNoFront) {
  Room room;
  room.scene = {};
  scene::add_material(room.scene, "floor", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(room.scene, {-1, 1, -1, 1}, 0, true, 0);
  scene::place_camera(room.scene, "below", {0, -3, 0.1f}, {0, 0, 0}, 0.5f);
  room.tracer = *trace::RayTracer::build(room.scene);
  std::vector<std::string> said;
  EXPECT_EQ(choose_camera({}, room.scene, room.tracer, "floor.glb", &said)->name, "fitted");
  EXPECT_THAT(said,
              ElementsAre(HasSubstr("camera 'below' of the file shows no front of a surface")));
}

}  // namespace
}  // namespace luxel::pipeline
