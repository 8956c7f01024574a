// Text .fbx files: units, axes, the node tree, materials, lights and a camera. Arrays of binary
// ones.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string settings(const std::string& unit, int up, int front, int front_sign,
                     int coord_sign = 1) {
  const auto number = [](const char* name, int value) {
    return fmt::format("P: \"{}\", \"int\", \"Integer\", \"\",{}\n", name, value);
  };
  return "FBXHeaderExtension: {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
         "GlobalSettings: {\nVersion: 1000\nProperties70: {\n" +
         number("UpAxis", up) + number("UpAxisSign", 1) + number("FrontAxis", front) +
         number("FrontAxisSign", front_sign) + number("CoordAxis", 0) +
         number("CoordAxisSign", coord_sign) +
         "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\"," + unit + "\n}\n}\n";
}
/// Centimetres, Z up, Y away from the viewer: what most exporters write.
std::string centimetres_z_up() { return settings("1", 2, 1, -1); }

std::string node(int id, const char* name, const char* kind, const char* moved,
                 const char* turned = "0,0,0", const char* more = "") {
  return fmt::format(
      "Model: {}, \"Model::{}\", \"{}\" {{\nVersion: 232\nProperties70: {{\n"
      "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{}\n"
      "P: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",{}\n{}}}\n}}\n",
      id, name, kind, moved, turned, more);
}

/// The square from 0 to 100 in x and y, with normals that lean.
std::string square(int id) {
  return fmt::format("Geometry: {}, \"Geometry::square\", \"Mesh\" {{", id) + R"(
    Vertices: *12 {
      a: 0,0,0,100,0,0,100,100,0,0,100,0
    }
    PolygonVertexIndex: *4 {
      a: 0,1,2,-4
    }
    GeometryVersion: 124
    LayerElementNormal: 0 {
      Version: 101
      MappingInformationType: "ByPolygonVertex"
      ReferenceInformationType: "Direct"
      Normals: *12 {
        a: 0,0.6,0.8,0,0.6,0.8,0,0.6,0.8,0,0.6,0.8
      }
    }
    LayerElementUV: 0 {
      Version: 101
      Name: "map1"
      MappingInformationType: "ByPolygonVertex"
      ReferenceInformationType: "IndexToDirect"
      UV: *8 {
        a: 0,0.25,1,0.25,1,1,0,1
      }
      UVIndex: *4 {
        a: 0,1,2,3
      }
    }
    LayerElementMaterial: 0 {
      Version: 101
      MappingInformationType: "AllSame"
      ReferenceInformationType: "IndexToDirect"
      Materials: *1 {
        a: 0
      }
    }
    Layer: 0 {
      LayerElement: {
        Type: "LayerElementNormal"
        TypedIndex: 0
      }
      LayerElement: {
        Type: "LayerElementMaterial"
        TypedIndex: 0
      }
      LayerElement: {
        Type: "LayerElementUV"
        TypedIndex: 0
      }
    }
  }
)";
}

constexpr const char* kLightsAndCamera = R"(
  NodeAttribute: 304, "NodeAttribute::bulb", "Light" {
    Properties70: {
      P: "LightType", "enum", "", "",0
      P: "Color", "Color", "", "A",1,0.5,0.25
      P: "Intensity", "Number", "", "A",400
    }
  }
  NodeAttribute: 305, "NodeAttribute::beam", "Light" {
    Properties70: {
      P: "LightType", "enum", "", "",2
      P: "Color", "Color", "", "A",1,1,1
      P: "Intensity", "Number", "", "A",100
      P: "InnerAngle", "Number", "", "A",40
      P: "OuterAngle", "Number", "", "A",60
    }
  }
  NodeAttribute: 306, "NodeAttribute::eye", "Camera" {
    Properties70: {
      P: "AspectWidth", "double", "Number", "",320
      P: "AspectHeight", "double", "Number", "",160
      P: "FieldOfView", "FieldOfView", "", "A",90
    }
  }
)";

constexpr const char* kFbxMaterials = R"(
  Material: 400, "Material::paint", "" {
    ShadingModel: "phong"
    Properties70: {
      P: "SpecularColor", "Color", "", "A",0.4,0.2,0.1
      P: "SpecularFactor", "Number", "", "A",0.5
      P: "ShininessExponent", "Number", "", "A",25
      P: "DiffuseColor", "Color", "", "A",0.5,0.6,0.7
      P: "DiffuseFactor", "Number", "", "A",0.5
    }
  }
  Material: 401, "Material::glow", "" {
    ShadingModel: "lambert"
    Properties70: {
      P: "DiffuseColor", "Color", "", "A",0.1,0.2,0.3
      P: "SpecularColor", "Color", "", "A",0.4,0.2,0.1
      P: "EmissiveColor", "Color", "", "A",1,0.5,0.25
      P: "EmissiveFactor", "Number", "", "A",8
    }
  }
  Texture: 500, "Texture::pic", "" {
    Type: "TextureVideoClip"
    FileName: "C:\author\pics\paint.png"
    RelativeFilename: "pics\paint.png"
  }
)";

std::string connections(const std::vector<std::pair<int, int>>& pairs, const char* more = "") {
  std::string text = "Connections: {\n";
  for (const auto& [child, parent] : pairs) text += fmt::format("C: \"OO\",{},{}\n", child, parent);
  return text + more + "}\n";
}

/// A room that holds a floor and its twin, and a lamp that looks down on them.
std::string room(const std::string& global_settings) {
  return global_settings + "Objects: {\n" + square(100) + square(101) +
         node(200, "room", "Null", "0,0,100") + node(201, "floor", "Mesh", "200,0,0") +
         node(202, "twin", "Mesh", "0,0,50") + node(203, "lamp", "Mesh", "0,0,300", "180,0,0") +
         node(204, "bulb", "Light", "10,20,200") +
         node(205, "beam", "Light", "10,20,200", "90,0,0") +
         node(206, "eye", "Camera", "0,-500,100", "90,0,90") + kLightsAndCamera + kFbxMaterials +
         "}\n" +
         connections({{200, 0},
                      {201, 200},
                      {202, 200},
                      {203, 200},
                      {204, 0},
                      {205, 0},
                      {206, 0},
                      {100, 201},
                      {100, 202},
                      {101, 203},
                      {304, 204},
                      {305, 205},
                      {306, 206},
                      {400, 201},
                      {400, 202},
                      {401, 203}},
                     "C: \"OP\",500,400, \"DiffuseColor\"\n");
}

/// One square, no material.
std::string lone_square(const std::string& global_settings, const char* node_properties = "") {
  return global_settings + "Objects: {\n" + square(100) +
         node(201, "floor", "Mesh", "0,0,0", "0,0,0", node_properties) + "}\n" +
         connections({{201, 0}, {100, 201}});
}

scene::Scene import_fbx_room() {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/paint.png", png_of(3, 1, {255, 255, 255, 255}));
  return scene_of(import_scene(folder.write("a.fbx", room(centimetres_z_up()))));
}

TEST(Fbx, CentimetresAndZUpBecomeMetresAndYUp) { expect_room_in_metres(import_fbx_room()); }

TEST(Fbx, AMeshUsedTwiceIsStoredOnce) {
  const scene::Scene scene = import_fbx_room();
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
  EXPECT_NE(scene.instances[0].mesh, scene.instances[2].mesh);
}

TEST(Fbx, MaterialsTexturesAndCoordinates) {
  const scene::Scene scene = import_fbx_room();
  ASSERT_EQ(scene.instances.size(), 3u);
  const scene::SurfacePoint floor{0, 0, {0.3f, 0.3f}}, lamp{2, 0, {0.3f, 0.3f}};
  EXPECT_EQ(scene::material_at(scene, floor).name, "paint");
  expect_near(scene::reflectance_at(scene, floor), {0.25f, 0.3f, 0.35f}, 1e-5f);
  expect_near(scene::emission_at(scene, floor), {0, 0, 0}, 0);
  expect_near(scene::reflectance_at(scene, lamp), {0.1f, 0.2f, 0.3f}, 1e-5f);
  expect_near(scene::emission_at(scene, lamp), {8, 4, 2}, 1e-5f);
  expect_near(scene::material_at(scene, floor).specular, {0.2f, 0.1f, 0.05f}, 1e-6f);
  EXPECT_FLOAT_EQ(scene::material_at(scene, floor).sharpness, 25);
  EXPECT_EQ(scene::material_at(scene, lamp).specular, Rgb{}) << "lambert";
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].width, 3);
  EXPECT_EQ(scene::material_at(scene, floor).base_color_texture.texture, 0u);
  // The file's v grows upwards, ours downwards.
  const scene::Mesh& mesh = scene.meshes[scene.instances[0].mesh];
  ASSERT_EQ(mesh.uv0.size(), 4u);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_FLOAT_EQ(mesh.uv0[v].x, mesh.positions[v].x > 0 ? 1.0f : 0.0f);
    EXPECT_FLOAT_EQ(mesh.uv0[v].y, mesh.positions[v].y > 0 ? 0.0f : 0.75f);
  }
}

// KayKit's files name a picture on the disk of their author; 3ds Max's procedural textures name
// none.
TEST(Fbx, PicturesOfOtherMachinesAreLookedForOrLost) {
  const auto with_picture = [](const std::string& name) {
    std::string text = room(centimetres_z_up());
    for (const std::string stated : {"C:\\author\\pics\\paint.png", "pics\\paint.png"})
      text.replace(text.find(stated), stated.size(), name);
    return text;
  };
  const TemporaryFolder root;
  std::filesystem::create_directory(root.path() / "fbx");
  std::filesystem::create_directory(root.path() / "textures");
  root.write("textures/Paint.png", png_of(3, 1, {128, 128, 128, 255}));
  const std::string absolute = with_picture("C:\\author\\assets\\paint.png");
  const auto found = import_scene(root.write("fbx/a.fbx", absolute));
  EXPECT_EQ(scene_of(found).textures.size(), 1u);
  EXPECT_THAT(found->warnings, IsEmpty());
  std::filesystem::remove(root.path() / "textures/Paint.png");
  for (const auto& [text, why] :
       {std::pair(absolute, "C:/author/assets/paint.png, which is missing"),
        std::pair(with_picture(""), "names no file")}) {
    const auto lost = import_scene(root.write("fbx/a.fbx", text));
    const scene::Scene scene = scene_of(lost);
    EXPECT_TRUE(scene.textures.empty());
    expect_near(scene::reflectance_at(scene, {0, 0, {0.3f, 0.3f}}), {0.25f, 0.3f, 0.35f}, 1e-5f);
    ASSERT_EQ(lost->warnings.size(), 1u);
    EXPECT_THAT(lost->warnings[0], HasSubstr(why));
    EXPECT_THAT(lost->warnings[0], HasSubstr("; the material's colour is used"));
  }
}

// Alpha grows along x; only the floor's material lets light through.
TEST(Fbx, VertexAlphaIsReadWhereAMaterialCountsIt) {
  std::string text = room(centimetres_z_up());
  const auto insert_before = [&](const std::string& mark, const char* more) {
    for (size_t at = text.find(mark); at != text.npos; at = text.find(mark, at)) {
      text.insert(at, more);
      at += std::strlen(more) + mark.size();
    }
  };
  insert_before("    LayerElementMaterial: 0 {\n      Version", R"(    LayerElementColor: 0 {
      Version: 101
      MappingInformationType: "ByPolygonVertex"
      ReferenceInformationType: "Direct"
      Colors: *16 {
        a: 1,1,1,0.25,1,1,1,0.75,1,1,1,0.75,1,1,1,0.25
      }
    }
)");
  insert_before("      LayerElement: {\n        Type: \"LayerElementUV\"",
                "LayerElement: {\nType: \"LayerElementColor\"\nTypedIndex: 0\n}\n");
  insert_before(
      "P: \"SpecularColor\", \"Color\", \"\", \"A\",0.4,0.2,0.1\n      P: \"SpecularFactor\"",
      "P: \"Opacity\", \"Number\", \"\", \"A\",0.5\n");
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "pics");
  folder.write("pics/paint.png", png_of(3, 1, {255, 255, 255, 255}));
  const scene::Scene scene = scene_of(import_scene(folder.write("a.fbx", text)));
  const scene::Mesh& floor = scene.meshes.at(scene.instances.at(0).mesh);
  ASSERT_EQ(floor.alphas.size(), 4u);
  for (size_t v = 0; v < 4; ++v)
    EXPECT_EQ(floor.alphas[v], floor.positions[v].x > 0 ? 0.75f : 0.25f);
  EXPECT_FLOAT_EQ(scene::passage_at(scene, {0, 0, {0, 0}}).coverage, 0.5f * floor.alphas[0]);
  const scene::Mesh& lamp = scene.meshes.at(scene.instances.at(2).mesh);
  EXPECT_EQ(lamp.colors.size(), 4u);
  EXPECT_TRUE(lamp.alphas.empty());
}

TEST(Fbx, LightsAndCameraAreInMetresToo) {
  const scene::Scene scene = import_fbx_room();
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].kind, scene::PunctualLight::Kind::point);
  expect_near(scene.lights[0].position, {0.1f, 2, -0.2f}, 1e-5f);
  expect_near(scene.lights[0].intensity, {4, 2, 1}, 1e-5f);
  EXPECT_EQ(scene.lights[1].kind, scene::PunctualLight::Kind::spot);
  expect_near(scene.lights[1].direction, {0, -1, 0}, 1e-5f);
  EXPECT_NEAR(scene.lights[1].inner_cone_rad, kPi / 9, 1e-5f);
  EXPECT_NEAR(scene.lights[1].outer_cone_rad, kPi / 6, 1e-5f);
  ASSERT_EQ(scene.cameras.size(), 1u);
  const scene::Camera& eye = scene.cameras[0];
  expect_near(transform_point(eye.world_from_camera, {}), {0, 1, 5}, 1e-5f);
  expect_near(transform_vector(eye.world_from_camera, {0, 0, -1}), {0, 0, -1}, 1e-5f);
  expect_near(transform_vector(eye.world_from_camera, {0, 1, 0}), {0, 1, 0}, 1e-5f);
  EXPECT_FLOAT_EQ(eye.aspect, 2);
  EXPECT_NEAR(eye.fov_y_rad, 2 * std::atan(0.5f), 1e-5f);
}

TEST(Fbx, LightsMayShareNamesWithEachOtherAndWithSurfaces) {
  const auto renamed = [](const std::string& from, const std::string& to) {
    std::string text = room(centimetres_z_up());
    for (size_t at; (at = text.find(from)) != text.npos;) text.replace(at, from.size(), to);
    const size_t texture = text.find("C: \"OP\"");  // this test has no picture
    return import_text("a.fbx", text.erase(texture, text.find('\n', texture) - texture));
  };
  for (const auto& imported :
       {renamed("Model::beam\"", "Model::bulb\""), renamed("Model::floor\"", "Model::bulb\"")}) {
    const scene::Scene scene = scene_of(imported);
    ASSERT_EQ(scene.lights.size(), 2u);
    expect_near(scene.lights[0].position, {0.1f, 2, -0.2f}, 1e-5f);
    EXPECT_EQ(scene.lights[1].kind, scene::PunctualLight::Kind::spot);
    expect_near(scene.lights[1].direction, {0, -1, 0}, 1e-5f);
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_NEAR(drawn_area(scene), 3, 1e-5f);
  }
  // A light and a camera: which node is whose is not known.
  const auto lost = renamed("Model::eye\"", "Model::bulb\"");
  EXPECT_EQ(scene_of(lost).lights.size(), 1u);
  EXPECT_THAT(all_of(lost->warnings), HasSubstr("light 'bulb' shares its name"));
  EXPECT_THAT(all_of(lost->warnings), HasSubstr("camera 'bulb' shares its name"));
}

TEST(Fbx, EveryUnitAndAxisIsTurnedIntoOurs) {
  const auto area = [](const std::string& unit) {
    return drawn_area(scene_of(import_text("a.fbx", lone_square(settings(unit, 1, 2, 1)))));
  };
  EXPECT_NEAR(area("1"), 1, 1e-5f);
  EXPECT_NEAR(area("100"), 1e4f, 0.1f) << "metres";
  EXPECT_NEAR(area("2.54"), 6.4516f, 1e-4f) << "inches";
  const auto normal = [](int up, int front, int front_sign) {
    return scene::front_normal(
        scene_of(import_text("a.fbx", lone_square(settings("1", up, front, front_sign)))), 0, 0);
  };
  expect_near(normal(1, 2, 1), {0, 0, 1}, 1e-6f);
  expect_near(normal(2, 1, -1), {0, 1, 0}, 1e-6f);
  const scene::Scene plain = scene_of(import_text("a.fbx", lone_square(settings("1", 1, 2, 1))));
  expect_near(scene::reflectance_at(plain, {0, 0, {0.3f, 0.3f}}), {0.8f, 0.8f, 0.8f}, 1e-6f);
}

TEST(Fbx, ALeftHandedFileIsNotMirroredAndKeepsItsFrontSides) {
  // x grows to the left: the square's front, +z, still looks at the viewer.
  const scene::Scene scene =
      scene_of(import_text("a.fbx", lone_square(settings("1", 1, 2, 1, -1))));
  expect_near(scene::front_normal(scene, 0, 0), {0, 0, 1}, 1e-6f);
  const Box3 box = scene::world_bounds(scene);
  EXPECT_NEAR(box.lower.x, -1, 1e-6f);
  EXPECT_NEAR(box.upper.x, 0, 1e-6f);
}

TEST(Fbx, PivotsAndGeometricTransformsAreApplied) {
  const scene::Scene scene = scene_of(import_text(
      "a.fbx", lone_square(settings("1", 1, 2, 1),
                           "P: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",-90,0,0\n"
                           "P: \"RotationPivot\", \"Vector3D\", \"Vector\", \"\",0,0,100\n"
                           "P: \"GeometricTranslation\", \"Vector3D\", \"Vector\", \"\",100,0,0\n"
                           "P: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",2,1,1\n")));
  // About (0, 0, 1): z = 0 is turned to y = -1, y becomes -z; then the shift of 1 is scaled by 2.
  const Box3 box = scene::world_bounds(scene);
  expect_near(box.lower, {2, -1, 0}, 1e-5f);
  expect_near(box.upper, {4, -1, 1}, 1e-5f);
}

TEST(Fbx, NonsenseUnitsAndAxesAreWarnings) {
  const auto unit = import_text("a.fbx", lone_square(settings("-1", 1, 2, 1)));
  EXPECT_NEAR(drawn_area(scene_of(unit)), 1, 1e-5f);
  EXPECT_THAT(all_of(unit->warnings), HasSubstr("UnitScaleFactor is -1"));
  const auto axes = import_text("a.fbx", lone_square(settings("1", 1, 1, 1)));
  expect_near(scene::front_normal(scene_of(axes), 0, 0), {0, 0, 1}, 1e-6f);
  EXPECT_THAT(all_of(axes->warnings), HasSubstr("are not three axes"));
}

/// Why a binary file is refused whose only element holds a text and an array of `bytes` zeros.
std::string error_of_array(char type, uint32_t count, bool is_compressed, uint32_t bytes,
                           uint64_t max_memory_bytes = 0) {
  const std::string values = std::string("S\4\0\0\0text", 9) + type +
                             bytes_of<uint32_t>({count, is_compressed, bytes}) +
                             std::string(bytes, '\0');
  std::string file = std::string("Kaydara FBX Binary  \0\x1a\0", 23) + bytes_of<uint32_t>({7400});
  const size_t end = file.size() + 13 + 8 + values.size();
  file += bytes_of<uint32_t>({uint32_t(end), 2, uint32_t(values.size())}) + "\10Vertices" + values +
          std::string(13, '\0');
  const auto all = std::as_bytes(std::span(file));
  const auto imported = import_bytes({all.begin(), all.end()}, "a.fbx", max_memory_bytes);
  return imported ? "no error" : imported.error().message;
}

// Assimp took 4 GB for the first.
TEST(Fbx, ArraysDoNotStateMoreThanTheyHold) {
  EXPECT_EQ(error_of_array('i', UINT32_MAX, false, 12),
            "a.fbx, byte 27: Vertices states 4294967295 numbers, more than its 12 bytes can hold");
  EXPECT_THAT(error_of_array('d', 2, false, 12), HasSubstr("more than its 12 bytes can hold"));
  EXPECT_THAT(error_of_array('f', 3, false, 12), Not(HasSubstr("can hold")));
  // zlib makes at most 1032 bytes of one.
  EXPECT_THAT(error_of_array('d', 1291, true, 10), HasSubstr("more than its 10 bytes can hold"));
  EXPECT_THAT(error_of_array('d', 1290, true, 10), Not(HasSubstr("can hold")));
  // 2^29 numbers of 8 bytes are none in 32 bits.
  EXPECT_THAT(error_of_array('d', 1u << 29, true, 1u << 22), HasSubstr("can hold"));
  EXPECT_THAT(error_of_array('d', 100'000'000, true, 1u << 20, uint64_t(512) << 20),
              HasSubstr("--max-memory"));
}

}  // namespace
}  // namespace luxel::import
