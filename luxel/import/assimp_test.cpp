// What comes through Assimp: .obj with its .mtl, and a word of .dae.
#include <gmock/gmock.h>

#include "luxel/import/test_files.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTwoSquares =
    "mtllib m.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 2\nv 1 0 2\nv 1 1 2\nv 0 1 2\n"
    "vt 0 0.25\nvt 1 0.25\nvt 1 1\nvt 0 1\n"
    "o floor\nusemtl white\nf 1/1 2/2 3/3 4/4\n"
    "o lamp\nusemtl glow\nf 5/1 6/2 7/3 8/4\n";

TEST(Obj, GroupsBecomeMeshesAndKeEmits) {
  const TemporaryFolder folder;
  folder.write("m.mtl",
               "newmtl white\nKd 0.5 0.6 0.7\nd 0.4\n\nnewmtl glow\nKd 0.1 0.1 0.1\nKe 17 12 4\n");
  const auto imported = import_scene(folder.write("a.obj", kTwoSquares));
  const scene::Scene scene = scene_of(imported);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "floor");
  EXPECT_EQ(scene.meshes[1].name, "lamp");
  EXPECT_TRUE(scene.meshes[0].normals.empty()) << "no normals in the file: flat";
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u) << "corners are joined";
  EXPECT_NEAR(drawn_area(scene), 2, 1e-6f);
  expect_near(scene::front_normal(scene, 0, 0), {0, 0, 1}, 1e-6f);
  const scene::SurfacePoint floor{0, 0, {0.3f, 0.3f}}, lamp{1, 0, {0.3f, 0.3f}};
  expect_near(scene::reflectance_at(scene, floor), {0.5f, 0.6f, 0.7f}, 1e-6f);
  EXPECT_FLOAT_EQ(scene::material_at(scene, floor).alpha, 0.4f);
  expect_near(scene::emission_at(scene, floor), {0, 0, 0}, 0);
  expect_near(scene::emission_at(scene, lamp), {17, 12, 4}, 1e-5f);
  // The file's v grows upwards, ours downwards.
  for (size_t v = 0; v < 4; ++v)
    EXPECT_FLOAT_EQ(scene.meshes[0].uv0[v].y, scene.meshes[0].positions[v].y > 0 ? 0.0f : 0.75f);
}

/// Two squares that meet at about 11 degrees along the z axis: below the usual crease angle.
constexpr const char* kFold = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv -1 -0.2 0\nv -1 -0.2 1\n";
constexpr const char* kFoldFaces = "f 1 2 3 4\nf 2 1 5 6\n";

Result<Imported> import_fold(const std::string& before, std::optional<float> crease_deg = {}) {
  const TemporaryFolder folder;
  ImportParams params;
  params.smooth_normals_deg = crease_deg;
  return import_scene(folder.write("a.obj", kFold + before + kFoldFaces), params);
}

// OBJ does not say how a mesh without normals looks. `s off` does; groups that are on are no news.
TEST(Obj, WithoutNormalsIsSmoothUnlessItsSmoothingGroupsAreOff) {
  const Vec3 mean = normalize(normalize(Vec3{0, 1, 0}) + normalize(Vec3{-0.2f, 1, 0}));
  for (const char* before : {"", "s 1\n", "s off\ns 2\n"}) {
    const scene::Scene scene = scene_of(import_fold(before));
    ASSERT_EQ(scene.meshes[0].normals.size(), 6u) << before;
    expect_near(scene.meshes[0].normals[0], mean, 1e-5f);
  }
  for (const char* before : {"s off\n", "s 0\n"})
    EXPECT_TRUE(scene_of(import_fold(before)).meshes[0].normals.empty()) << before;
}

TEST(Obj, WithoutNormalsTakesTheCreaseAngleThatWasAskedFor) {
  EXPECT_TRUE(scene_of(import_fold("", 11.0f)).meshes[0].normals.empty());
  EXPECT_FALSE(scene_of(import_fold("", 12.0f)).meshes[0].normals.empty());
  EXPECT_TRUE(scene_of(import_fold("s 1\n", 0.0f)).meshes[0].normals.empty());
  EXPECT_FALSE(scene_of(import_fold("s off\n", 30.0f)).meshes[0].normals.empty());
}

TEST(Obj, KsAndNsAreTheHighlight) {
  const TemporaryFolder folder;
  folder.write("m.mtl",
               "newmtl white\nKd 0.5 0.6 0.7\nKs 0.1 0.2 0.3\nNs 42\nillum 2\n\n"
               "newmtl glow\nKd 0.1 0.1 0.1\n");
  const scene::Scene scene = scene_of(import_scene(folder.write("a.obj", kTwoSquares)));
  const scene::Material& white = scene::material_at(scene, {0, 0, {}});
  expect_near(white.specular, {0.1f, 0.2f, 0.3f}, 1e-6f);
  EXPECT_FLOAT_EQ(white.sharpness, 42);
  EXPECT_EQ(scene::material_at(scene, {1, 0, {}}).specular, Rgb{}) << "no Ks: no highlight";
}

TEST(Obj, HighlightsThatAreNoNumbersAreRefusedOrClamped) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl white\nKd 0.5 0.6 0.7\nKs -0.1 0.2 0.3\nNs -2\n");
  const auto imported = import_scene(folder.write("a.obj", kTwoSquares));
  const scene::Scene scene = scene_of(imported);
  EXPECT_EQ(scene::material_at(scene, {0, 0, {}}).specular, (Rgb{0, 0.2f, 0.3f}));
  EXPECT_EQ(scene::material_at(scene, {0, 0, {}}).sharpness, 0);
  EXPECT_THAT(all_of(imported->warnings), HasSubstr("specular"));
}

TEST(Obj, GroupOfTwoMaterialsIsOneMesh) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl a\nKd 0.1 0.1 0.1\nnewmtl b\nKd 0.2 0.2 0.2\n");
  const scene::Scene scene =
      scene_of(import_scene(folder.write("a.obj",
                                         "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                         "g both\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n")));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "both");
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_NE(scene.meshes[0].triangle_material[0], scene.meshes[0].triangle_material[1]);
}

// Assimp alone cuts names of `o` at a blank and gives faces of one that is opened again to others.
TEST(Obj, GroupsKeepTheirWholeNamesAndFacesWhereverTheyAreOpened) {
  const TemporaryFolder folder;
  const scene::Scene scene = scene_of(import_scene(
      folder.write("a.obj",
                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                   "o north wall\nf 1 2 3\no north door\nf 1 2 3\ng lock\nf 1 2 3\ng\nf 1 3 4\n"
                   "o house\ng lock\nf 2 3 4\no north wall \r\nf 1 3 4\n")));
  ASSERT_EQ(scene.instances.size(), 4u);
  const std::vector<std::pair<std::string, size_t>> expected{
      {"north wall", 2}, {"north door", 2}, {"lock", 1}, {"lock", 1}};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scene.instances[i].name, expected[i].first);
    EXPECT_EQ(scene.meshes[scene.instances[i].mesh].triangles.size(), expected[i].second) << i;
  }
}

TEST(Obj, BentFacesAreSaidWithTheirGroup) {
  const TemporaryFolder folder;
  const std::string flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 1 0.01\no roof\nf 1 2 3 4\n";
  EXPECT_TRUE(import_scene(folder.write("a.obj", flat))->warnings.empty());
  const auto bent = import_scene(folder.write("b.obj", flat + "o hall\nf 1 2 5 4\n"));
  ASSERT_EQ(bent->warnings.size(), 1u);
  EXPECT_THAT(bent->warnings[0], HasSubstr("line 9; in 'hall'"));
}

TEST(Obj, MissingMaterialFileIsAWarning) {
  const auto imported = import_text("a.obj", kTwoSquares);
  const scene::Scene scene = scene_of(imported);
  EXPECT_THAT(all_of(imported->warnings), HasSubstr("m.mtl, which is missing"));
  expect_near(scene::reflectance_at(scene, {0, 0, {0.3f, 0.3f}}), {0.8f, 0.8f, 0.8f}, 1e-6f);
}

TEST(Obj, TexturesAreFoundThroughBackslashesAndMissingOnesNamed) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/glow.png", png_of(3, 1, {255, 255, 255, 255}));
  folder.write("m.mtl",
               "newmtl white\nKd 0.5 0.5 0.5\nmap_Kd pics\\glow.png\n"
               "newmtl glow\nKe 2 2 2\nmap_Ke pics\\glow.png\n");
  const scene::Scene scene = scene_of(import_scene(folder.write("a.obj", kTwoSquares)));
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 3);
  expect_near(scene::emission_at(scene, {1, 0, {0.3f, 0.3f}}), {2, 2, 2}, 1e-5f);

  folder.write("m.mtl", "newmtl white\nmap_Kd lost.png\n");
  const auto imported = import_scene(folder.path() / "a.obj");
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr("lost.png"));
  EXPECT_THAT(imported.error().message, HasSubstr("white"));
}

}  // namespace
}  // namespace luxel::import
