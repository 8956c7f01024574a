// Text .x files: Direct3D's left-handed space, frames, materials; and damaged ones, on which Assimp
// would end the process.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

/// A square of 2 x 1 in front of the viewer, who looks along +z, and a lamp behind it.
constexpr const char* kRoom = R"(xof 0303txt 0032
template Mesh {
 <3D82AB44-62DA-11cf-AB39-0020AF71E433>
 DWORD nVertices;
 array Vector vertices[nVertices];
 [...]
}
// shared by name
Material paint {
 0.5;0.6;0.7;1.0;;
 10.0;
 0.1;0.1;0.1;;
 0.0;0.0;0.0;;
 TextureFilename { "pics\\paint.png"; }
}
Frame room {
 FrameTransformMatrix {
  1.0,0.0,0.0,0.0, 0.0,1.0,0.0,0.0, 0.0,0.0,1.0,0.0, 0.0,0.0,10.0,1.0;;
 }
 Frame floor {
  FrameTransformMatrix {
   1.0,0.0,0.0,0.0, 0.0,1.0,0.0,0.0, 0.0,0.0,1.0,0.0, 2.0,3.0,4.0,1.0;;
  }
  Mesh square {
   4;
   0.0;0.0;0.0;,
   2.0;0.0;0.0;,
   2.0;1.0;0.0;,
   0.0;1.0;0.0;;
   1;
   4;0,3,2,1;;
   MeshNormals {
    1;
    0.0;0.6;-0.8;;
    1;
    4;0,0,0,0;;
   }
   MeshTextureCoords {
    4;
    0.0;0.75;,
    1.0;0.75;,
    1.0;0.0;,
    0.0;0.0;;
   }
   MeshVertexColors {
    4;
    0;1.0;0.5;0.25;1.0;,
    1;1.0;0.5;0.25;1.0;,
    2;1.0;0.5;0.25;1.0;,
    3;1.0;0.5;0.25;1.0;;
   }
   MeshMaterialList {
    1;
    1;
    0;;
    { paint }
   }
   SkinWeights {
    "room";
    2;
    0,1;
    0.5,0.5;
    1.0,0.0,0.0,0.0, 0.0,1.0,0.0,0.0, 0.0,0.0,1.0,0.0, 0.0,0.0,0.0,1.0;;
   }
  }
 }
 Frame lamp {
  Mesh {
   3;
   0.0;0.0;0.0;,
   0.0;1.0;0.0;,
   1.0;0.0;0.0;;
   1;
   3;0,1,2;;
   MeshMaterialList {
    1;
    1;
    0;;
    Material glow {
     0.1;0.2;0.3;1.0;;
     0.0;
     0.0;0.0;0.0;;
     17.0;12.0;4.0;;
    }
   }
  }
 }
}
)";

constexpr const char* kPlain =
    "xof 0303txt 0032\nMesh {\n3;\n0;0;0;,\n0;1;0;,\n1;0;0;;\n1;\n3;0,1,2;;\n}\n";

Result<Imported> import_x(const std::string& text) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/paint.png", png_of(3, 1, {255, 255, 255, 255}));
  return import_scene(folder.write("a.x", text));
}

TEST(DirectX, TheLeftHandedSpaceIsTurnedIntoOurs) {
  const scene::Scene scene = scene_of(import_x(kRoom));
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].name, "floor");
  EXPECT_NEAR(drawn_area(scene), 2.5f, 1e-6f);
  // Right stays right and up stays up: far away is -z now, and the picture is not mirrored.
  const Box3 box = scene::world_bounds(scene);
  expect_near(box.lower, {0, 0, -14}, 1e-6f);
  expect_near(box.upper, {4, 4, -10}, 1e-6f);
  expect_near(scene::front_normal(scene, 0, 0), {0, 0, 1}, 1e-6f);
  expect_near(scene::front_normal(scene, 1, 0), {0, 0, 1}, 1e-6f);
  expect_near(scene::shading_normal(scene, {0, 0, {0.3f, 0.3f}}), {0, 0.6f, 0.8f}, 1e-6f);
}

TEST(DirectX, MaterialsTexturesAndCoordinates) {
  const scene::Scene scene = scene_of(import_x(kRoom));
  ASSERT_EQ(scene.instances.size(), 2u);
  const scene::SurfacePoint floor{0, 0, {0.3f, 0.3f}}, lamp{1, 0, {0.3f, 0.3f}};
  EXPECT_EQ(scene::material_at(scene, floor).name, "paint");
  expect_near(scene::material_at(scene, floor).specular, {0.1f, 0.1f, 0.1f}, 1e-6f);
  EXPECT_FLOAT_EQ(scene::material_at(scene, floor).sharpness, 10);
  expect_near(scene::reflectance_at(scene, floor), {0.5f, 0.3f, 0.175f}, 1e-5f);
  expect_near(scene::reflectance_at(scene, lamp), {0.1f, 0.2f, 0.3f}, 1e-6f);
  expect_near(scene::emission_at(scene, floor), {0, 0, 0}, 0);
  expect_near(scene::emission_at(scene, lamp), {17, 12, 4}, 1e-5f);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 3);
  // Direct3D's v grows downwards, as ours does.
  const scene::Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.uv0.size(), 4u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_FLOAT_EQ(mesh.uv0[v].x, mesh.positions[v].x > 0 ? 1.0f : 0.0f);
    EXPECT_FLOAT_EQ(mesh.uv0[v].y, mesh.positions[v].y > 0 ? 0.0f : 0.75f);
  }
}

TEST(DirectX, WithoutFramesAndMaterials) {
  for (const char* mark : {"", "\xef\xbb\xbf"}) {
    const scene::Scene scene = scene_of(import_x(std::string(mark) + kPlain));
    EXPECT_NEAR(drawn_area(scene), 0.5f, 1e-6f);
    expect_near(scene::reflectance_at(scene, {0, 0, {0.3f, 0.3f}}), {0.8f, 0.8f, 0.8f}, 1e-6f);
  }
}

struct XDamage {
  const char *from, *to, *says;
};
/// For the names of tests.
void PrintTo(const XDamage& p, std::ostream* out) { *out << p.says; }
class DamagedDirectX : public ::testing::TestWithParam<XDamage> {};

TEST_P(DamagedDirectX, IsAnError) {
  std::string text = kRoom;
  const std::string from = GetParam().from;
  const size_t at = text.find(from);
  ASSERT_NE(at, text.npos);
  const auto imported = import_x(text.replace(at, from.size(), GetParam().to));
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr(GetParam().says));
  EXPECT_THAT(imported.error().message, HasSubstr("a.x, line "));
}

INSTANTIATE_TEST_SUITE_P(
    Places, DamagedDirectX,
    ::testing::Values(
        XDamage{"4;0,3,2,1;;", "4;0,3,2,4;;", "vertex index 4 is out of range, there are 4"},
        XDamage{"4;0,3,2,1;;", "4;0,3,2,-1;;", "vertex index -1 is out of range"},
        XDamage{"4;0,3,2,1;;", "4;0,3,two,1;;", "'two' is not a whole number"},
        XDamage{"4;0,3,2,1;;", "4000000000;0,3,2,1;;", "the count 4000000000 is more than"},
        XDamage{"square {\n   4;", "square {\n   999999999;", "the count 999999999 is more than"},
        XDamage{"4;0,0,0,0;;", "4;0,0,1,0;;", "normal index 1 is out of range, there are 1"},
        XDamage{"-0.8;;\n    1;", "-0.8;;\n    2;", "2 faces with normals, but the mesh has 1"},
        XDamage{"Coords {\n    4;", "Coords {\n    3;",
                "3 texture coordinates, but the mesh has 4"},
        XDamage{"Colors {\n    4;", "Colors {\n    5;", "5 vertex colours, but the mesh has 4"},
        XDamage{"3;1.0;0.5", "4;1.0;0.5", "the vertex of a colour 4 is out of range"},
        XDamage{"    { paint }\n", "", "material index 0 is out of range, the mesh lists 0"},
        XDamage{"Material glow", "Materiel glow", "material index 0 is out of range"},
        XDamage{"2.0;1.0;0.0;,", "2.0;nan;0.0;,", "'nan' is not a finite number"},
        XDamage{"2.0;1.0;0.0;,", "2.0;1e39;0.0;,", "'1e39' is not a finite number"},
        XDamage{"0.5;0.6;0.7", "0.5;inf;0.7", "'inf' is not a finite number"},
        XDamage{"\"pics\\\\paint.png\"", "paint.png",
                "'paint.png' stands in place of a picture's name in quotes"},
        XDamage{"4;0,3,2,1;;", "0;;", "a face has no corner"},
        XDamage{"square {", "square", "stands in place of '{'"}));

// Assimp would take a lone ; for an object's name and step over what comes next, the end of the
// mesh included, and 0,1 for a tenth.
TEST(DirectX, SeparatorsMayStandAnywhere) {
  std::string text = kRoom;
  for (const auto& [from, to] : {std::pair("4;0,3,2,1;;", "4;0,3,2,1;;; ,"),
                                 {"0.0;0.0;;\n }\n}\nFrame room", "0.0;0.0;;\n; }\n};\nFrame room"},
                                 {"2.0;0.0;0.0;,", "2,0,0"},
                                 {"{ paint }", ", { paint };"}}) {
    const size_t at = text.find(from);
    if (at != text.npos) text.replace(at, std::string_view(from).size(), to);
  }
  const scene::Scene scene = scene_of(import_x(text));
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_NEAR(drawn_area(scene), 2.5f, 1e-6f);
  EXPECT_EQ(scene::material_at(scene, {0, 0, {0.3f, 0.3f}}).name, "paint");
}

// Assimp would crash on the material list that stands behind the first mesh.
TEST(DirectX, MeshesWithoutFacesAreLeftOut) {
  const std::string empty = "Mesh { 1; 0.0;0.0;0.0;; 0;; }\n";
  const std::string list =
      "MeshMaterialList { 1; 1; 0; Material { 0.8;0.8;0.8;1.0;; 1.0; "
      "0.0;0.0;0.0;; 0.0;0.0;0.0;; } }\n";
  std::string text = kPlain;
  text.insert(text.find("Mesh"), empty + list);
  EXPECT_NEAR(drawn_area(scene_of(import_x(text))), 0.5f, 1e-6f);
}

// Assimp gives the one material to the first face.
TEST(DirectX, AMaterialOfNoFaceIsAnError) {
  const auto imported = import_x(
      "xof 0303txt 0032\nMesh { 1; 0.0;0.0;0.0;; 0; MeshMaterialList { 1; 1; 0; Material { "
      "0.8;0.8;0.8;1.0;; 1.0; 0.0;0.0;0.0;; 0.0;0.0;0.0;; } } }\n");
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message,
              HasSubstr("a.x, line 2: there are 1 material indices, but the mesh has 0 faces"));
}

TEST(DirectX, AFileThatEndsEarlyIsAnErrorWhereverItEnds) {
  const std::string text = kRoom;
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/paint.png", png_of(3, 1, {255, 255, 255, 255}));
  const size_t last_brace = text.rfind('}');
  for (size_t size = 1; size < last_brace; size += size < 20 ? 1 : 7) {
    const auto imported = import_scene(folder.write("a.x", text.substr(0, size)));
    ASSERT_FALSE(imported) << size;
    EXPECT_EQ(imported.error().message.find("substr"), std::string::npos) << size;
  }
}

TEST(DirectX, FramesInFramesWithoutEndAreAnError) {
  std::string text = "xof 0303txt 0032\n";
  for (int i = 0; i < 100000; ++i) text += "Frame {\n";
  const auto imported = import_x(text);
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr("more than 1000 frames"));
}

}  // namespace
}  // namespace luxel::import
