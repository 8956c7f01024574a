#include "luxel/pipeline/bake/dark_lamps.h"

#include <gmock/gmock.h>

#include "luxel/scene/light_kinds.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A floor, 3 m below a ceiling that faces it, and a closed box on the floor.
scene::Scene room_with_a_box(std::vector<Vec3> lamps) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f}, {});
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 0, true, 0);
  scene::add_rectangle(scene, {-5, 5, -5, 5}, 3, false, 0);
  scene::Mesh box;
  box.name = "box";
  scene::add_box(box, {1, 0, 1}, {2, 1, 2}, 0);
  scene::place(scene, std::move(box));
  for (const Vec3 at : lamps) {
    scene::PunctualLight lamp;
    lamp.name = "lamp", lamp.position = at;
    scene.lights.push_back(lamp);
  }
  return scene;
}

std::vector<std::string> said_of_lamps(const scene::Scene& scene) {
  const auto tracer = trace::RayTracer::build(scene);
  EXPECT_TRUE(tracer);
  return about_dark_lamps(scene, *tracer, [&](const scene::SurfacePoint& p) {
    const Vec3 at = scene::world_position(scene, p);
    return p.instance == 0 && at.x > 1 && at.x < 2 && at.z > 1 && at.z < 2;
  });
}

TEST(DarkLamps, OnesThatLightSomethingAreNotNamed) {
  // In the air, in the ceiling, a hair above it, and in a face of the box.
  EXPECT_THAT(
      said_of_lamps(room_with_a_box({{0, 1, 0}, {0, 3, 0}, {0, 3.00001f, 0}, {1.5f, 1, 1.5f}})),
      IsEmpty());
}

TEST(DarkLamps, OnesInsideOfThingsAreNamed) {
  EXPECT_THAT(said_of_lamps(room_with_a_box({{0, 1, 0}, {1.1f, 0.5f, 1.5f}})),
              ElementsAre("light 'lamp' lights nothing: it lies 100 mm behind the front of 'box' "
                          "(instance 2); move it out of there"));
  scene::Scene above = room_with_a_box({{0, 3.005f, 0}});
  above.lights[0].name = "";
  EXPECT_THAT(said_of_lamps(above),
              ElementsAre(AllOf(HasSubstr("light 0 lights nothing: it lies 5"),
                                HasSubstr(" mm behind the front of"))));
  for (scene::Material& m : above.materials) m.double_sided = true;
  EXPECT_THAT(said_of_lamps(above), IsEmpty()) << "it lights the ceiling's back";
}

TEST(DarkLamps, OnesWhoseRangeEndsBeforeAnySurfaceAreNamed) {
  scene::Scene scene = room_with_a_box({{0, 1.5f, 0}});
  scene.lights[0].range_m = 1;
  EXPECT_THAT(said_of_lamps(scene),
              ElementsAre("light 'lamp' lights nothing: no surface lies before it "
                          "within its range of 1 m"));
  scene.lights[0].range_m = 1.6f;
  EXPECT_THAT(said_of_lamps(scene), IsEmpty());
}

// Above the ceiling, down to which the cone reaches, and with one that looks up into the void.
TEST(DarkLamps, SpotsLookWithinTheirCones) {
  scene::Scene scene = room_with_a_box({{0, 3.5f, 0}, {0, 2, 0}, {0, 3.5f, 0}});
  for (scene::PunctualLight& lamp : scene.lights)
    lamp.kind = scene::LightKind::spot, lamp.outer_cone_rad = 0.02f;
  scene.lights[2].direction = {0, 1, 0};
  EXPECT_THAT(said_of_lamps(scene), ElementsAre(HasSubstr("lies 0.5 m behind")));
}

TEST(DarkLamps, ThreeAreNamedAndTheOthersCounted) {
  scene::Scene scene = room_with_a_box(std::vector<Vec3>(17, {1.5f, 0.5f, 1.5f}));
  EXPECT_THAT(said_of_lamps(scene),
              ElementsAre(HasSubstr("'box'"), HasSubstr("'box'"), HasSubstr("'box'"),
                          "and 14 more lights light nothing"));
  scene.lights[0].intensity = {};
  EXPECT_EQ(said_of_lamps(scene).back(), "and 13 more lights light nothing");
}

}  // namespace
}  // namespace luxel::pipeline
