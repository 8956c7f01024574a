// Each test breaks one thing of a good scene and states what must become of it.
#include "luxel/scene/validate.h"

#include <gmock/gmock.h>

namespace luxel::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The unit square, drawn once.
Scene good_scene() {
  Scene scene;
  Mesh mesh;
  mesh.name = "quad";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_material = {0, 0};
  scene.meshes = {mesh};
  scene.instances = {{"it", 0, {}}};
  Material material;
  material.name = "paint";
  material.base_color = {0.5f, 0.5f, 0.5f};
  scene.materials = {material};
  return scene;
}

std::string warnings_of(Scene& scene) {
  const auto warnings = validate(scene, "f.glb");
  if (!warnings) return "error: " + warnings.error().message;
  std::string text;
  for (const std::string& w : *warnings) text += w + "\n";
  return text;
}

std::string error_of(Scene scene) {
  const auto warnings = validate(scene, "f.glb");
  return warnings ? "no error" : warnings.error().message;
}

TEST(Validate, GoodSceneIsLeftAlone) {
  Scene scene = good_scene();
  scene.meshes[0].normals.assign(4, {0, 0, 1});
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
}

TEST(Validate, VertexColoursAndAlphasAreRepaired) {
  Scene scene = good_scene();
  scene.meshes[0].colors = {{-1, 0, 0}, {0, NAN, 0}, {0, 0, 2}, {1, 1, 1}};
  scene.meshes[0].alphas = {-0.5f, INFINITY, 2, 0.25f};
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("5 vertex colours are negative or not finite, or alpha above 1; repaired"));
  EXPECT_EQ(scene.meshes[0].colors, (std::vector<Rgb>{{0, 0, 0}, {1, 1, 1}, {0, 0, 2}, {1, 1, 1}}));
  EXPECT_EQ(scene.meshes[0].alphas, (std::vector<float>{0, 1, 1, 0.25f}));
  scene.meshes[0].alphas.pop_back();
  EXPECT_THAT(error_of(scene), HasSubstr("3 alphas for 4 positions"));
}

TEST(Validate, ZeroAreaTrianglesAreDroppedAndCounted) {
  Scene scene = good_scene();
  Mesh& mesh = scene.meshes[0];
  mesh.positions.insert(mesh.positions.end(),
                        {{0.1f, 0.2f, 0.7f}, {0.2f, 0.4f, 1.4f}, {0.3f, 0.6f, 2.1f}, {1, 0, 0}});
  mesh.triangles = {{1, 1, 2}, {0, 1, 2}, {4, 5, 6}, {1, 7, 2}};  // the first: corners repeated;
  mesh.triangle_material = {0, 0, 0, 0};  // the third: on a line up to rounding; the last: twins
  EXPECT_THAT(warnings_of(scene), HasSubstr("3 zero-area triangles dropped from mesh 0 (quad)"));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0][1], 1u);
  EXPECT_EQ(mesh.triangle_material.size(), 1u);
}

// Area has no smallest value: the scene's unit of length is nobody's business.
TEST(Validate, SliversAndSmallScenesStay) {
  for (const float scale : {1e-4f, 1.0f, 1e6f}) {
    Scene scene = good_scene();
    scene.meshes[0].positions[2] = {1, 1e-5f, 0};
    scene.instances[0].world_from_object = scaling({scale, scale, scale});
    EXPECT_EQ(warnings_of(scene), "") << scale;
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u) << scale;
  }
}

TEST(Validate, NoTriangleWithoutDirectionInTheWorld) {
  Scene scene = good_scene();
  scene.instances.push_back({"far", 0, translation({1e9f, 0, 0})});
  EXPECT_THAT(warnings_of(scene), HasSubstr("no triangles"));
}

// A unit square 1e9 m away has corners that single precision rounds to one place.
TEST(Validate, WhatRoundingTakesAwayIsNamed) {
  Scene scene = good_scene();
  scene.meshes.push_back(scene.meshes[0]);
  scene.instances.push_back({"far", 1, translation({1e9f, 0, 0})});
  EXPECT_THAT(warnings_of(scene), AllOf(HasSubstr("2 triangles are smaller than the steps"),
                                        HasSubstr("where instance 1 (far) puts them")));
}

TEST(Validate, TooLargeCoordinatesAreErrorsThatNameTheirPlace) {
  for (const float large : {1.5e9f, 1e12f, 1e19f, 3e38f}) {
    Scene scene = good_scene();
    scene.meshes[0].positions[3].y = -large;
    EXPECT_THAT(error_of(scene),
                HasSubstr(fmt::format("mesh 0 (quad), vertex 3: position (0, {}, 0) is too large: "
                                      "coordinates go up to 1e+09 m",
                                      -large)));
    scene = good_scene();
    scene.instances[0].world_from_object = translation({0, 0, large});
    EXPECT_THAT(error_of(scene), AllOf(HasSubstr("instance 0 (it)"), HasSubstr("quad), vertex 0"),
                                       HasSubstr("up to 1e+09 m")));
    scene.instances[0].world_from_object = scaling({large, large, large});
    EXPECT_THAT(error_of(scene), AllOf(HasSubstr("instance 0 (it)"), HasSubstr("quad), vertex 1")));
    // Normals overflow, and no vertex is far away.
    for (Vec3& p : scene.meshes[0].positions) p = p * (1 / large);
    EXPECT_THAT(error_of(scene), HasSubstr("instance 0 (it): its transform scales by"));
  }
  Scene scene = good_scene();
  scene.lights.push_back({});
  scene.lights[0].name = "sun", scene.lights[0].position = {0, 1.5e11f, 0};
  EXPECT_EQ(error_of(scene), "no error");
  scene.lights[0].position.y = 1e19f;
  EXPECT_THAT(error_of(scene), HasSubstr("light 0 (sun): position (0, 1e+19, 0) is too large"));
}

// Squares of all sizes that are held, and of those that are not; none is said to have no area.
TEST(Validate, AreasAreKeptWithinTheRangeAndNamedBeyond) {
  const auto square = [](float side) {
    Scene scene = good_scene();
    for (Vec3& p : scene.meshes[0].positions) p = p * side;
    return scene;
  };
  for (const float side : {1e9f, 1e5f, 1e-5f, 1e-9f, 4e-10f}) {
    Scene scene = square(side);
    EXPECT_EQ(warnings_of(scene), "") << side;
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u) << side;
    // Every solver asks a triangle for these.
    EXPECT_NEAR(front_normal(scene, 0, 0).z, 1, 1e-6f) << side;
    EXPECT_NEAR(area_m2(world_triangle(scene, 0, 1)) / side / side, 0.5f, 1e-6f) << side;
  }
  EXPECT_THAT(error_of(square(1e12f)), HasSubstr("too large"));
  EXPECT_THAT(error_of(square(1e-12f)),
              AllOf(HasSubstr("no triangles left"), HasSubstr("2 triangles are too small"),
                    HasSubstr("mesh 0 (quad)"), HasSubstr("scale the scene up")));
}

// The triangle's corners near the origin are rounded by nanometres, and the far one by metres, but
// along its long sides. Its area is that of its stored numbers, 0.25 m^2 or more.
TEST(Validate, OneFarVertexIsNoReasonToDropATriangle) {
  for (const Vec3 far : {Vec3{9e8f, 1, 0}, Vec3{9e8f, 0.5f, 0}, Vec3{9e8f, -9e8f, 9e8f}}) {
    Scene scene = good_scene();
    scene.meshes[0].positions[2] = far;
    EXPECT_EQ(warnings_of(scene), "");
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  }
  // Here the rounding of the far one moves it by 32 m across, and the area is less than this.
  Scene scene = good_scene();
  scene.meshes[0].positions = {{0, 0, 0}, {1, 1, 0}, {9e8f, 9e8f, 0.5f}, {0, 1, 0}};
  EXPECT_THAT(warnings_of(scene), HasSubstr("1 zero-area triangles dropped"));
}

// One vertex far away says nothing about where rays leave the rest.
TEST(Validate, AFarVertexMakesNothingElseSmall) {
  Scene scene = good_scene();
  Mesh& mesh = scene.meshes[0];
  for (uint32_t k = 0; k < 3; ++k)
    mesh.triangles.push_back(mesh.triangles[0]), mesh.triangle_material.push_back(0);
  EXPECT_EQ(warnings_of(scene), "");
  mesh.positions[3] = {9e8f, 0.5f, 0};
  EXPECT_EQ(warnings_of(scene), "");
}

// Rays start 2^-21 of 1e8 m off a house of 20 m there, which is 48 m: it casts no shadow.
TEST(Validate, TrianglesThatLightWillMissAreNamed) {
  Scene scene = good_scene();
  scene.instances[0].world_from_object = translation({1e8f, 0, 0}) * scaling({32, 32, 32});
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("2 of 2 triangles are smaller than the distance at which rays start off "
                        "them, 47.7 m for mesh 0 (quad), which has coordinates of 1e+08 m"));
  scene.instances[0].world_from_object = translation({1e7f, 0, 0}) * scaling({32, 32, 32});
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(Validate, InstancesOfNoSizeAreDropped) {
  for (const float scale : {1e-10f, -1e-12f, 1e-30f}) {
    Scene scene = good_scene();
    scene.instances.push_back({"dot", 0, scaling({scale, scale, scale})});
    EXPECT_THAT(warnings_of(scene), AllOf(HasSubstr("1 instances are scaled down to nothing"),
                                          HasSubstr("instance 1 (dot)")));
    EXPECT_EQ(scene.instances.size(), 1u);
  }
}

TEST(Validate, CamerasThatMakeNoPictureAreDropped) {
  const auto kept = [](const Camera& camera) {
    Scene scene = good_scene();
    scene.cameras = {camera};
    EXPECT_THAT(error_of(scene), "no error");
    return warnings_of(scene).empty();
  };
  const auto placed = [](const Mat34& world_from_camera) {
    Camera camera;
    camera.world_from_camera = world_from_camera;
    return camera;
  };
  EXPECT_TRUE(kept({}));
  for (const float scale : {1e-15f, 1e-9f, 1e15f})
    EXPECT_TRUE(kept(placed(scaling({scale, scale, scale})))) << scale;
  // The length of an axis is 0 or infinite in single precision, or two axes are one.
  for (const float scale : {0.0f, 1e-20f, 1e20f})
    EXPECT_FALSE(kept(placed(scaling({scale, scale, scale})))) << scale;
  EXPECT_FALSE(kept(placed(from_columns({1, 0, 0}, {1, 0, 0}, {0, 0, 1}, {}))));
  EXPECT_FALSE(kept(placed(translation({1e12f, 0, 0}))));
  Camera shaped;
  for (const float aspect : {1e-30f, 1e30f, -1.0f, NAN}) {
    shaped.aspect = aspect;
    EXPECT_FALSE(kept(shaped)) << aspect;
  }
  shaped = Camera{};
  shaped.orthographic_height_m = 1e12f;
  EXPECT_FALSE(kept(shaped));
}

TEST(Validate, SquashedInstancesAreDropped) {
  Scene scene = good_scene();
  scene.instances.push_back({"flat", 0, scaling({1, 0, 1})});
  EXPECT_THAT(warnings_of(scene), HasSubstr("instance 1 (flat)"));
  EXPECT_EQ(scene.instances.size(), 1u);
}

TEST(Validate, ReflectanceIsClampedByItsFactor) {
  Scene scene = good_scene();
  scene.materials[0].base_color = {2, 0.5f, 1};
  scene.materials[0].metallic = 0.25f;
  EXPECT_THAT(warnings_of(scene),
              AllOf(HasSubstr("reflectance over 0.99"), HasSubstr("material 0 (paint)")));
  EXPECT_FLOAT_EQ(scene.materials[0].base_color.x * 0.75f, 0.99f);
  EXPECT_EQ(scene.materials[0].base_color.y, 0.5f);
  EXPECT_EQ(scene.materials[0].base_color.z, 1) << "0.75 is no news";
}

TEST(Validate, WhatIsFullyTransparentIsNamed) {
  for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask}) {
    Scene scene = good_scene();
    scene.materials[0].alpha = 0, scene.materials[0].alpha_mode = mode;
    EXPECT_THAT(warnings_of(scene), HasSubstr("2 triangles of 'paint' are fully transparent"));
    EXPECT_EQ(scene.materials[0].alpha, 0) << "the file says so";
  }
  Scene opaque = good_scene(), faint = good_scene(), unused = good_scene();
  opaque.materials[0].alpha = 0;
  faint.materials[0].alpha = 0.01f, faint.materials[0].alpha_mode = AlphaMode::blend;
  unused.materials.push_back(unused.materials[0]);
  unused.materials[1].alpha = 0, unused.materials[1].alpha_mode = AlphaMode::blend;
  for (Scene* scene : {&opaque, &faint, &unused}) EXPECT_EQ(warnings_of(*scene), "");
}

// Clamping the factor of a textured material would darken its dark texels too.
TEST(Validate, TexturedReflectanceIsWarnedOfAndKept) {
  Scene scene = good_scene();
  scene.materials[0].base_color = {1, 1, 1};
  scene.materials[0].base_color_texture.texture = 0;
  Texture texture;
  texture.width = 2, texture.height = 1;
  texture.rgba = {255, 9, 9, 255, 128, 9, 9, 255};
  scene.textures = {texture};
  EXPECT_THAT(warnings_of(scene), HasSubstr("reflectance over 0.99"));
  EXPECT_EQ(scene.materials[0].base_color, (Rgb{1, 1, 1}));
  scene.textures[0].rgba[0] = 200;
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(Validate, NormalsBecomeUnitAndBadOnesFlat) {
  Scene scene = good_scene();
  scene.meshes[0].normals = {{0, 0, 3}, {NAN, 0, 0}, {0, 0, 0}, {1e-30f, 0, 0}};
  EXPECT_THAT(warnings_of(scene), HasSubstr("2 vertex normals"));
  const std::vector<Vec3>& normals = scene.meshes[0].normals;
  for (const int v : {0, 1, 2}) EXPECT_NEAR(length(normals[size_t(v)] - Vec3{0, 0, 1}), 0, 1e-6f);
  EXPECT_NEAR(length(normals[3] - Vec3{1, 0, 0}), 0, 1e-6f) << "tiny, but it has a direction";
}

TEST(Validate, NotFiniteNumbersAreErrorsThatNameTheirPlace) {
  Scene scene = good_scene();
  scene.meshes[0].positions[2].y = NAN;
  EXPECT_THAT(error_of(scene), HasSubstr("f.glb: mesh 0 (quad), vertex 2"));
  scene = good_scene();
  scene.instances[0].world_from_object.row[1][3] = INFINITY;
  EXPECT_THAT(error_of(scene), HasSubstr("instance 0 (it)"));
  scene = good_scene();
  scene.materials[0].emission.x = NAN;
  EXPECT_THAT(error_of(scene), HasSubstr("material 0 (paint)"));
  scene = good_scene();
  scene.lights.push_back({});
  scene.lights[0].intensity.z = INFINITY;
  EXPECT_THAT(error_of(scene), HasSubstr("light 0"));
}

TEST(Validate, ProfilesAreGridsOfCandela) {
  Scene scene = good_scene();
  scene.profiles.push_back({"lamp.ies", LightProfile::Angles::c, {0, 1}, {0}, {5, 4}});
  EXPECT_EQ(error_of(scene), "no error");
  scene.profiles[0].candela[1] = NAN;
  EXPECT_THAT(error_of(scene), HasSubstr("profile 0 (lamp.ies): nan is not a number"));
  scene.profiles[0].candela = {5};
  EXPECT_THAT(error_of(scene), HasSubstr("1 candela for 2 x 1 angles"));
  scene.profiles[0].candela = {5, 4}, scene.profiles[0].vertical_rad = {1, 1};
  EXPECT_THAT(error_of(scene), HasSubstr("do not ascend"));
}

TEST(Validate, EveryIndexIsChecked) {
  Scene scene = good_scene();
  scene.meshes[0].triangles[1][2] = 4;
  EXPECT_THAT(error_of(scene), HasSubstr("mesh 0 (quad), triangle 1: vertex index 4"));
  scene = good_scene();
  scene.meshes[0].triangle_material[1] = 1;
  EXPECT_THAT(error_of(scene), HasSubstr("triangle 1: material index 1"));
  scene = good_scene();
  scene.instances[0].mesh = 1;
  EXPECT_THAT(error_of(scene), HasSubstr("mesh index 1"));
  scene = good_scene();
  scene.materials[0].emission_texture.texture = 0;
  EXPECT_THAT(error_of(scene), HasSubstr("texture index 0"));
  scene = good_scene();
  scene.meshes[0].uv1.resize(3);
  EXPECT_THAT(error_of(scene), HasSubstr("3 uv1 for 4 positions"));
  scene = good_scene();
  scene.textures.push_back({"t", 2, 2, std::vector<uint8_t>(15), {}, ""});
  EXPECT_THAT(error_of(scene), HasSubstr("15 bytes"));
  scene = good_scene();
  scene.lights.push_back({});
  scene.lights[0].profile = 0;
  EXPECT_THAT(error_of(scene), HasSubstr("light 0: profile index 0"));
}

TEST(Validate, SceneWithoutTrianglesIsRefused) {
  Scene scene = good_scene();
  scene.instances.clear();
  EXPECT_THAT(error_of(scene), HasSubstr("no triangles"));
  EXPECT_THAT(error_of(Scene{}), HasSubstr("no triangles"));
}

TEST(HasLight, AnyOfThreeWillDo) {
  Scene scene = good_scene();
  EXPECT_FALSE(has_light(scene));
  scene.background = {0, 0.1f, 0};
  EXPECT_TRUE(has_light(scene));
  scene = good_scene();
  scene.lights.push_back({});
  EXPECT_TRUE(has_light(scene));
  scene.lights[0].intensity = {};
  EXPECT_FALSE(has_light(scene));
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emission = {1, 0, 0};
  EXPECT_FALSE(has_light(scene)) << "no triangle has it";
  scene.meshes[0].triangle_material[1] = 1;
  EXPECT_TRUE(has_light(scene));
}

}  // namespace
}  // namespace luxel::scene
