#include "luxel/scene/digest.h"

#include <gtest/gtest.h>

#include <functional>

namespace luxel::scene {
namespace {

/// One or two of everything.
Scene digested_scene() {
  Scene s;
  Mesh chair;
  chair.name = "chair";
  chair.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  chair.triangles = {{0, 1, 2}};
  chair.triangle_material = {0};
  s.meshes = {chair, chair};
  s.meshes[1].name = "";
  s.instances = {{"Chair by the door", 0, {}}, {"Other", 1, {}}};
  s.materials.resize(2);
  s.materials[1].name = "oak";
  s.textures = {{"grain", 1, 1, {1, 2, 3, 4}, {}, ""}};
  s.lights.resize(1);
  s.lights[0].name = "Lamp";
  s.profiles = {{"down.ies", LightProfile::Angles::c, {0, 1}, {0}, {5, 6}}};
  s.cameras.resize(1);
  s.environment = {1, 1, {{1, 1, 1}}, 0};
  return s;
}

std::string digests_changed_by(const std::function<void(Scene&)>& edit) {
  const Scene before = digested_scene();
  Scene now = before;
  edit(now);
  return difference(digests_of(before), digests_of(now));
}

TEST(SceneDigest, OfTheSameSceneIsTheSame) {
  EXPECT_EQ(digests_changed_by([](Scene&) {}), "");
  // Names in a file change no light, nor does the compression of a picture.
  EXPECT_EQ(digests_changed_by([](Scene& s) {
              s.name = "other", s.meshes[0].name = "stool", s.lights[0].name = "L";
              s.textures[0].encoded.resize(7), s.textures[0].mime_type = "image/png";
            }),
            "");
}

TEST(SceneDigest, NamesEachKindOfChange) {
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.meshes[0].positions[2].y = 1.0000001f; }),
            "mesh 'chair' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) {
              s.meshes[1].triangles[0] = {1, 2, 0};
            }),
            "mesh number 2 has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.meshes[0].uv1.resize(3); }),
            "mesh 'chair' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.instances[0].world_from_object.row[0][3] = 0.1f; }),
            "instance 'Chair by the door' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.materials[1].base_color.y = 0.5f; }),
            "material 'oak' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.materials[0].emission_texture.rotation = 1; }),
            "material number 1 has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.materials[0].double_sided = true; }),
            "material number 1 has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.textures[0].rgba[3] = 5; }),
            "texture 'grain' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.lights[0].angular_radius_rad = 0.1f; }),
            "light 'Lamp' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.profiles[0].candela[1] = 7; }),
            "profile 'down.ies' has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.cameras[0].fov_y_rad = 1; }),
            "camera number 1 has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) {
              s.background = {0, 0, 1};
            }),
            "the background has changed");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.environment.rotation_rad = 1; }),
            "the environment has changed");
}

TEST(SceneDigest, NamesWhatIsMoreOrLess) {
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.lights.resize(3); }),
            "1 of kind light there, 3 here");
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.instances.clear(); }),
            "2 of kind instance there, 0 here");
}

TEST(SceneDigest, KnowsTheOrder) {
  EXPECT_EQ(digests_changed_by([](Scene& s) { s.instances[1].mesh = 0, s.instances[0].mesh = 1; }),
            "instance 'Chair by the door' has changed");
}

}  // namespace
}  // namespace luxel::scene
