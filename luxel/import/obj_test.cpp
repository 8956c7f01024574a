// .obj files and their .mtl: each kind of line, as programs write them.
#include <gmock/gmock.h>

#include "luxel/base/vec_double.h"
#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

// OBJ does not say how a mesh without normals looks, unless it states smoothing groups.
TEST(Obj, WithoutNormalsIsSmoothUnlessItsSmoothingGroupsAreOff) {
  // Unit normals times areas, 1 and the root of 1.04.
  const Vec3 mean = normalize(Vec3{0, 1, 0} + Vec3{-0.2f, 1, 0});
  for (const char* before : {"", "s 1\n", "s off\ns 2\n"}) {
    const scene::Scene scene = scene_of(import_fold(before));
    ASSERT_EQ(scene.meshes[0].normals.size(), 6u) << before;
    expect_near(scene.meshes[0].normals[0], mean, 1e-5f);
  }
  for (const char* before : {"s off\n", "s 0\n"})
    EXPECT_TRUE(scene_of(import_fold(before)).meshes[0].normals.empty()) << before;
}

TEST(Obj, SmoothingGroupsAreFollowed) {
  const std::string corner = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv 0 -1 0\nv 0 -1 1\n";
  const auto normals = [&](const std::string& first, const std::string& second) {
    return scene_of(import_text("a.obj", corner + first + "f 1 2 3 4\n" + second + "f 2 1 5 6\n"))
        .meshes[0]
        .normals;
  };
  EXPECT_TRUE(normals("", "").empty()) << "90 degrees are sharp where nothing is said";
  EXPECT_TRUE(normals("s 1\n", "s 2\n").empty());
  EXPECT_TRUE(normals("", "s 1\n").empty()) << "off until it is on";
  EXPECT_TRUE(normals("s 3\n", "s off\n").empty());
  const std::vector<Vec3> round = normals("s 3 # round\n", "");
  ASSERT_EQ(round.size(), 6u);
  expect_near(round[0], normalize(Vec3{-1, 1, 0}), 1e-5f);
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

TEST(Obj, TexturesAreFoundThroughBackslashesAndLostOnesNamed) {
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

  folder.write("m.mtl",
               "newmtl white\nmap_Kd lost.png\nnewmtl glow\nKd 0.1 0.2 0.3\nKe 2 2 2\n"
               "map_Ke lost.png\nmap_Kd lost.png\n");
  const auto imported = import_scene(folder.path() / "a.obj");
  const scene::Scene without = scene_of(imported);
  EXPECT_THAT(imported->warnings,
              ElementsAre(HasSubstr("the texture of material 0 (white) is lost.png, which is "
                                    "missing; put it beside the scene or name its folder with "
                                    "--search-path; the material's colour is used"),
                          HasSubstr("; it does not glow")));
  expect_near(without.materials[0].base_color, {0.8f, 0.8f, 0.8f}, 1e-6f);
  expect_near(without.materials[1].base_color, {0.1f, 0.2f, 0.3f}, 1e-6f);
  EXPECT_EQ(max_component(without.materials[1].emission), 0);
}

constexpr const char* kUnitSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Lines as programs write them, and what they draw.
struct Written {
  const char* what;
  std::string text;
  float area_m2;
  size_t triangles;
};

TEST(Obj, LinesOfManyProgramsAreRead) {
  const std::string square = kUnitSquare;
  for (const Written& w : {
           Written{"a face that goes on", square + "f 1 2 \\\n3 4\n", 1, 2},
           Written{"so, with CRLF",
                   "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 \\\r\n3 \\\r\n4\r\n", 1, 2},
           Written{"so, at the end of the file", square + "f 1 2 3 4 \\", 1, 2},
           Written{"a comment with a folder at its end",
                   "# C:\\models\\\n" + square + "f 1 2 3 4\n", 1, 2},
           Written{"numbers without a leading zero",
                   "v -.5 -.5 +.0\nv .5 -.5 0.\nv 5.e-1 .5E0 -0\nv -.5 +5e-1 0\nf 1 2 3 4\n", 1, 2},
           Written{"numbers too small for a float", "v 1e-60 0 0\n" + square + "f 2 3 4 5\n", 1, 2},
           Written{"comments after each kind of line",
                   "v 0 0 0 # a\nv 1 0 0#b\nv 1 1 0\t# c\nvt 0 0 # d\nvn 0 0 1 # e\n"
                   "f 1/1/1 2/1/1 3/1/1 # one of 2\n",
                   0.5f, 1},
           Written{"faces of one and two corners", square + "f 1 2\nf 3\nf 1 2 3 4\nf 3 4\n", 1, 2},
           Written{"a byte order mark", "\xEF\xBB\xBF" + square + "f 1 2 3 4\n", 1, 2},
           Written{"lines that end with CR alone", "v 0 0 0\rv 1 0 0\rv 1 1 0\rf 1 2 3\r", 0.5f, 1},
           Written{"the old word for a face", square + "fo 1 2 3 4\n", 1, 2},
           Written{"weights of rational curves", "v 0 0 0 2\nv 1 0 0 0.5\nv 1 1 0 0\nf 1 2 3\n",
                   0.5f, 1},
           Written{"negative indices", square + "f -4 -3 -2 -1\n" + square + "f -1 -2 -3 -4\n", 2,
                   4},
           Written{"indices that refer ahead", "f 1 2 3 4\n" + square, 1, 2},
           Written{"slashes without a number", "vt 0 0\n" + square + "f 1/ 2// 3/1/ 4\n", 1, 2},
           Written{"points, lines, curves and what shows them",
                   square + "p 1\nl 1 2 3\nvp 0.5\ncstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\n"
                            "parm u 0 1\nend\nlod 1\nbevel on\nc_interp off\nshadow_obj a.obj\n"
                            "mg 1 0.5\nctech cparm 1\nf 1 2 3 4\n",
                   1, 2},
           Written{"as Rhino breaks and orders them",
                   "# Rhino\r\n\r\nmtllib a.mtl\r\ng object_1\r\nusemtl diffuse\r\n"
                   "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nvn 0 0 1\r\n"
                   "f 1/1/1 2/1/1 \\\r\n3/1/1 4/1/1\r\n",
                   1, 2},
           Written{
               "as 3ds Max comments them",
               "# 3ds Max Wavefront OBJ Exporter\n#\n# object Box01\n#\nv  0.0000 0.0000 0.0000\n"
               "v  1.0000 0.0000 0.0000\nv  1.0000 1.0000 0.0000\n# 3 vertices\n\n"
               "vn 0.0000 0.0000 1.0000\n# 1 vertex normals\n\ng Box01\nusemtl wire\ns 1\n"
               "f 1//1 2//1 3//1 \n# 1 faces\n\n",
               0.5f, 1},
           Written{"as MeshLab does, normals first",
                   "vn 0 0 1\nv 0 0 0 0.5 0.5 0.5\nvn 0 0 1\nv 1 0 0 0.5 0.5 0.5\nvn 0 0 1\n"
                   "v 1 1 0 0.5 0.5 0.5\n# 3 vertices, 0 vertices normals\n\nf 1//1 2//2 3//3\n",
                   0.5f, 1},
       }) {
    const auto imported = import_text("a.obj", w.text);
    const scene::Scene scene = scene_of(imported);
    EXPECT_NEAR(drawn_area(scene), w.area_m2, 1e-6f) << w.what;
    size_t triangles = 0;
    for (const scene::Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    EXPECT_EQ(triangles, w.triangles) << w.what;
  }
}

TEST(Obj, CoordinatesAreThoseOfTheText) {
  const scene::Scene scene = scene_of(import_text(
      "a.obj",
      "v 0.1 -.3 1e-3\nv 12345.678 0 0\nv 1 7.25 0\nvt 0.1 0.7\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "a");
  EXPECT_EQ(scene.meshes[0].positions[0], (Vec3{0.1f, -0.3f, 1e-3f}));
  EXPECT_EQ(scene.meshes[0].positions[1], (Vec3{12345.678f, 0, 0}));
  EXPECT_NEAR(scene.meshes[0].uv0[0].x, 0.1f, 1e-7f);
  EXPECT_NEAR(scene.meshes[0].uv0[0].y, 0.3f, 1e-7f);
}

TEST(Obj, ColoursOfSomeVerticesLeaveTheOthersWhite) {
  const scene::Scene scene = scene_of(import_text(
      "a.obj", "v 0 0 0\nv 1 0 0 0.25 0.5 0.75\nv 1 1 0\nv 0 1 0 1 0 0 1\nf 1 2 3 4\n"));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].colors,
            (std::vector<Rgb>{{1, 1, 1}, {0.25f, 0.5f, 0.75f}, {1, 1, 1}, {1, 0, 0}}));
  EXPECT_EQ(scene.meshes[0].positions[3], (Vec3{0, 1, 0}));
}

TEST(Obj, MaterialsMayChangeWithinAGroup) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl a\nKd 0.1 0.1 0.1\nnewmtl b c\nKd 0.2 0.2 0.2\nnewmtl unused\n");
  const scene::Scene scene = scene_of(import_scene(folder.write(
      "a.obj", std::string("mtllib m.mtl\n") + kUnitSquare +
                   "g all\nusemtl b c\nf 1 2 3\nusemtl a\nf 1 3 4\nusemtl \"b c\"\nf 1 2 4\n"
                   "usemtl lost\nf 2 3 4\n")));
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.meshes[0].triangle_material, (std::vector<uint32_t>{0, 1, 0, 2}));
  EXPECT_EQ(scene.materials[0].name, "b c");
  EXPECT_EQ(scene.materials[0].base_color, (Rgb{0.2f, 0.2f, 0.2f}));
  EXPECT_EQ(scene.materials[2].name, "lost");
  EXPECT_EQ(scene.materials[2].base_color, (Rgb{0.8f, 0.8f, 0.8f}));
}

/// The colour that the square's picture, red on the left and green on the right, has at (u, v).
Rgb picture_at(const std::string& options, Barycentric at) {
  const TemporaryFolder folder;
  std::vector<uint8_t> pixels = {255, 0, 0, 255, 0, 255, 0, 255};
  std::string png;
  stbi_write_png_to_func(append_to_string, &png, 2, 1, 4, pixels.data(), 8);
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/my brick.png", png);
  folder.write("m.mtl", "newmtl a\nmap_Kd " + options + " pics\\my brick.png\n");
  const scene::Scene scene = scene_of(
      import_scene(folder.write("a.obj", std::string("mtllib m.mtl\n") + kUnitSquare +
                                             "vt 0 0\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/3\n")));
  return scene.meshes.empty() ? Rgb{} : scene::reflectance_at(scene, {0, 0, at});
}

// Texture coordinates of the triangle are (u + v, v).
TEST(Obj, PicturesHaveTheirOptions) {
  const Barycentric left{0.25f, 0}, right{0.75f, 0};
  EXPECT_GT(picture_at("", left).x, 0.9f);
  EXPECT_GT(picture_at("", right).y, 0.9f);
  EXPECT_GT(picture_at("-o 0.5 0 0", left).y, 0.9f) << "moved by half of it";
  EXPECT_GT(picture_at("-o 0.5", right).x, 0.9f) << "and begins again";
  EXPECT_GT(picture_at("-clamp on -o 0.5", right).y, 0.9f) << "or does not";
  EXPECT_GT(picture_at("-s 2 1 1", {0.125f, 0}).x, 0.9f);
  EXPECT_GT(picture_at("-s 2 1 1", {0.375f, 0}).y, 0.9f) << "half as wide";
  EXPECT_GT(picture_at("-blendu on -mm 0 1 -texres 512 -imfchan m -bm 0.5 -t 0 0", right).y, 0.9f);
}

TEST(Obj, NamesBecomeUtf8) {
  const std::string latin1 = "T\xFCr", utf8 = "T\xC3\xBCr", unknown = "T\xEF\xBF\xBDr";
  for (const auto& [name, expected] : {std::pair{latin1, unknown}, {utf8, utf8}}) {
    const scene::Scene scene = scene_of(import_text(
        "a.obj", std::string(kUnitSquare) + "o " + name + "\nusemtl " + name + "\nf 1 2 3\n"));
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].name, expected);
    EXPECT_EQ(scene.meshes[0].name, expected);
    EXPECT_EQ(scene.materials[0].name, expected);
  }
}

TEST(Obj, WhatIsLeftOutIsSaid) {
  const std::string face = std::string(kUnitSquare) + "f 1 2 3\n";
  EXPECT_THAT(import_text("a.obj", face)->warnings, IsEmpty());
  EXPECT_THAT(all_of(import_text("a.obj", face + "surf 0 1 0 1 1 2 3 4\nend\n")->warnings),
              HasSubstr("free-form surfaces are left out: 1; export them as polygons"));
  EXPECT_THAT(all_of(import_text("a.obj", face + "f 1 3 2 4\n")->warnings),
              HasSubstr("crosses itself: 1, the first in line 6"));
}

TEST(Obj, AFaceOfManyCornersKeepsItsArea) {
  std::string text;
  for (int k = 0; k < 300; ++k)
    text += fmt::format("v {} {} 0\n", std::cos(k * 2 * kPiDouble / 300),
                        std::sin(k * 2 * kPiDouble / 300));
  text += "f";
  for (int k = 1; k <= 300; ++k) text += fmt::format(" {}", k);
  EXPECT_NEAR(drawn_area(scene_of(import_text("a.obj", text + "\n"))),
              150 * std::sin(2 * kPiDouble / 300), 1e-4);
  std::string many = std::string(kUnitSquare) + "f";
  for (int k = 0; k < 70'000; ++k) many += " 1";
  EXPECT_THAT(error_of(import_text("a.obj", many)),
              HasSubstr("a.obj, line 5: the face has more than 65536 corners; divide it"));
}

TEST(Obj, ErrorsNameTheLineWhereAStatementBegins) {
  EXPECT_THAT(error_of(import_text("a.obj", "v 0 0 0\nv 1 \\\n0 \\\nx\n")),
              HasSubstr("a.obj, line 2: 'x' is not a finite number"));
  EXPECT_THAT(error_of(import_text("a.obj", "v 0 0\n")),
              HasSubstr("a.obj, line 1: 2 numbers, must be 3"));
  EXPECT_THAT(error_of(import_text("a.obj", std::string(kUnitSquare) + "f 1 2 x3\n")),
              HasSubstr("a.obj, line 5: 'x3' is not a vertex index"));
}

TEST(Obj, MemoryIsCountedBeforeItIsTaken) {
  std::string text = kUnitSquare;  // a face of six bytes needs over 700
  while (text.size() < 3'000'000) text += "f 1 2 3\n";
  EXPECT_EQ(import_bytes({reinterpret_cast<const std::byte*>(text.data()),
                          reinterpret_cast<const std::byte*>(text.data()) + text.size()},
                         "a.obj", 1)
                .error()
                .code,
            ErrorCode::out_of_memory);
}

}  // namespace
}  // namespace luxel::import
