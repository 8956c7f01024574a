// Geometry and nodes of glTF. Every case is the unit square, or something that must become it.
#include <gmock/gmock.h>

#include <span>

#include "luxel/base/base64.h"
#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using ::testing::HasSubstr;

/// Two triangles that cover the unit square and face +z.
void expect_unit_square(const scene::Scene& scene) {
  ASSERT_EQ(scene.instances.size(), 1u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_NEAR(drawn_area(scene), 1.0f, 1e-6f);
  for (uint32_t t = 0; t < 2; ++t) expect_near(scene::front_normal(scene, 0, t), {0, 0, 1}, 1e-6f);
  const Box3 box = scene::world_bounds(scene);
  expect_near(box.lower, {0, 0, 0}, 0);
  expect_near(box.upper, {1, 1, 0}, 0);
}

template <class T>
Gltf square_with_indices(int component_type) {
  Gltf gltf;
  const int positions = gltf.floats(square_corners(), "VEC3", 3);
  const int indices = gltf.add<T>({0, 1, 2, 0, 2, 3}, component_type, "SCALAR", 1);
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return gltf;
}

TEST(Gltf, EveryIndexTypeGivesTheSquare) {
  expect_unit_square(scene_of(import_glb(square_with_indices<uint8_t>(5121))));
  expect_unit_square(scene_of(import_glb(square_with_indices<uint16_t>(5123))));
  expect_unit_square(scene_of(import_glb(square_with_indices<uint32_t>(5125))));
}

TEST(Gltf, NoIndicesGiveTheSquareWithFourJoinedVertices) {
  Gltf gltf;
  const int positions =
      gltf.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3);
  gltf.draw({{"attributes", {{"POSITION", positions}}}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  expect_unit_square(scene);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
}

// Four vertices a, b, c, d: a strip is (a b c), (c b d) -> order a=00, b=10, c=01, d=11.
TEST(Gltf, StripKeepsItsFront) {
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 3);
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"mode", 5}});
  expect_unit_square(scene_of(import_glb(gltf)));
}

TEST(Gltf, FanKeepsItsFront) {
  Gltf gltf;
  const int positions = gltf.floats(square_corners(), "VEC3", 3);
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"mode", 6}});
  expect_unit_square(scene_of(import_glb(gltf)));
}

TEST(Gltf, PointsAndLinesAreSkippedWithAWarning) {
  Gltf gltf = square_gltf();
  gltf.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  const auto imported = import_glb(gltf);
  expect_unit_square(scene_of(imported));
  EXPECT_THAT(all_of(imported->warnings), HasSubstr("primitive 1 is made of points or lines"));
}

TEST(Gltf, SparseValuesReplaceTheirElements) {
  Gltf gltf;
  std::vector<float> corners = square_corners();
  corners[6] = 77, corners[7] = 88;  // corner 2 is wrong, the sparse part mends it
  const int wrong = gltf.floats(corners, "VEC3", 3);
  const int index_view = gltf.view(bytes_of<uint8_t>({2}));
  const int value_view = gltf.view(bytes_of<float>({1, 1, 0}));
  gltf.json["accessors"][size_t(wrong)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", index_view}, {"componentType", 5121}}},
      {"values", {{"bufferView", value_view}}}};
  gltf.draw({{"attributes", {{"POSITION", wrong}}}, {"mode", 6}});
  expect_unit_square(scene_of(import_glb(gltf)));
}

TEST(Gltf, SparseWithoutAViewStartsFromZeros) {
  Gltf gltf;
  const int index_view = gltf.view(bytes_of<uint16_t>({1, 2, 3}));
  const int value_view = gltf.view(bytes_of<float>({1, 0, 0, 1, 1, 0, 0, 1, 0}));
  const int positions =
      gltf.accessor({{"componentType", 5126},
                     {"count", 4},
                     {"type", "VEC3"},
                     {"sparse",
                      {{"count", 3},
                       {"indices", {{"bufferView", index_view}, {"componentType", 5123}}},
                       {"values", {{"bufferView", value_view}}}}}});
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"mode", 6}});
  expect_unit_square(scene_of(import_glb(gltf)));
}

TEST(Gltf, InterleavedVerticesAreReadWithTheirStride) {
  Gltf gltf;
  const int view = gltf.view(bytes_of<float>(
      {0, 0, 0, .1f, .2f, 1, 0, 0, .3f, .4f, 1, 1, 0, .5f, .6f, 0, 1, 0, .7f, .8f}));
  gltf.json["bufferViews"][size_t(view)]["byteStride"] = 20;
  const nlohmann::json common = {{"bufferView", view}, {"componentType", 5126}, {"count", 4}};
  nlohmann::json positions = common, uv = common;
  positions["type"] = "VEC3";
  uv["type"] = "VEC2";
  uv["byteOffset"] = 12;
  const int p = gltf.accessor(positions), t = gltf.accessor(uv);
  gltf.draw({{"attributes", {{"POSITION", p}, {"TEXCOORD_0", t}}}, {"mode", 6}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  expect_unit_square(scene);
  EXPECT_EQ(scene.meshes[0].uv0[3], (Vec2{.7f, .8f}));
}

TEST(Gltf, NormalizedAndQuantizedIntegersAreScaled) {
  Gltf gltf;
  const int positions =
      gltf.add<int16_t>({0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0}, 5122, "VEC3", 3);  // not normalised
  const int uv0 = gltf.add<uint8_t>({0, 255, 51, 102, 0, 0, 0, 0}, 5121, "VEC2", 2, true);
  const int uv1 = gltf.add<uint16_t>({0, 65535, 13107, 0, 0, 0, 0, 0}, 5123, "VEC2", 2, true);
  const int colors = gltf.add<uint8_t>(std::vector<uint8_t>(16, 51), 5121, "VEC4", 4, true);
  const int normals =
      gltf.add<int8_t>({0, 0, 127, 0, 0, 127, 0, 0, 127, 0, 0, 127}, 5120, "VEC3", 3, true);
  gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  gltf.draw({{"attributes",
              {{"POSITION", positions},
               {"TEXCOORD_0", uv0},
               {"TEXCOORD_1", uv1},
               {"COLOR_0", colors},
               {"NORMAL", normals}}},
             {"mode", 6}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_NEAR(drawn_area(scene), 4.0f, 1e-6f);
  const scene::Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.uv0[0], (Vec2{0, 1}));
  EXPECT_FLOAT_EQ(mesh.uv0[1].x, 0.2f);
  EXPECT_FLOAT_EQ(mesh.uv0[1].y, 0.4f);
  EXPECT_FLOAT_EQ(mesh.uv1[1].x, 0.2f);
  expect_near(mesh.colors[0], {0.2f, 0.2f, 0.2f}, 1e-6f);
  EXPECT_EQ(mesh.normals[0], (Vec3{0, 0, 1}));
}

/// The square with a corner of each alpha, as two primitives that share their vertices.
scene::Mesh mesh_with_alphas(const std::vector<float>& alphas, const char* first,
                             const char* second, bool with_normals = false) {
  Gltf gltf = square_gltf();
  std::vector<float> colors;
  for (const float alpha : alphas) colors.insert(colors.end(), {1, 0.5f, 0.25f, alpha});
  gltf.json["materials"] = {{{"alphaMode", first}}, {{"alphaMode", second}}};
  auto& primitives = gltf.json["meshes"][0]["primitives"];
  primitives[0]["attributes"]["COLOR_0"] = gltf.floats(colors, "VEC4", 4);
  primitives.push_back(primitives[0]);
  for (const size_t k : {0, 1}) primitives[k]["material"] = k;
  if (with_normals)
    primitives[1]["attributes"]["NORMAL"] =
        gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  return scene_of(import_glb(gltf)).meshes.at(0);
}

TEST(Gltf, VertexAlphaIsReadWhereAMaterialCountsIt) {
  const std::vector<float> ramp{0, 0.25f, 0.5f, 1};
  for (const char* mode : {"MASK", "BLEND"}) {
    EXPECT_EQ(mesh_with_alphas(ramp, mode, mode).alphas, ramp);
    EXPECT_EQ(mesh_with_alphas(ramp, "OPAQUE", mode).alphas, ramp) << "the second one's, too";
    EXPECT_TRUE(mesh_with_alphas({1, 1, 1, 1}, mode, mode).alphas.empty());
  }
  const scene::Mesh opaque = mesh_with_alphas(ramp, "OPAQUE", "OPAQUE");
  EXPECT_TRUE(opaque.alphas.empty());
  EXPECT_EQ(opaque.colors.size(), 4u);
  // The first primitive is flat: its triangles have corners of their own.
  const scene::Mesh flat = mesh_with_alphas(ramp, "MASK", "MASK", true);
  EXPECT_EQ(flat.alphas, (std::vector<float>{0, 0.25f, 0.5f, 0, 0.5f, 1, 0, 0.25f, 0.5f, 1}));
}

// Two squares, of which only the second has colours; without indices vertices that differ in alpha
// alone stay apart.
TEST(Gltf, VertexAlphaOfOnePrimitiveAndWithoutIndices) {
  Gltf gltf = square_gltf();
  auto& primitives = gltf.json["meshes"][0]["primitives"];
  gltf.json["materials"] = {{{"alphaMode", "MASK"}}};
  const int corners =
      gltf.floats({0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 0, 1, 1}, "VEC3", 3);
  std::vector<float> colors(24, 1);
  for (size_t v = 3; v < 6; ++v) colors[4 * v + 3] = 0.5f;
  primitives.push_back(
      {{"attributes", {{"POSITION", corners}, {"COLOR_0", gltf.floats(colors, "VEC4", 4)}}},
       {"material", 0}});
  const scene::Mesh mesh = scene_of(import_glb(gltf)).meshes.at(0);
  EXPECT_EQ(mesh.positions.size(), 10u) << "the diagonal's ends are there twice";
  EXPECT_EQ(mesh.alphas, (std::vector<float>{1, 1, 1, 1, 1, 1, 1, 0.5f, 0.5f, 0.5f}));
}

TEST(Gltf, BuffersMayBeExternalOrBase64) {
  const Gltf gltf = square_gltf();
  nlohmann::json document = gltf.json;
  const TemporaryFolder folder;
  folder.write("data 1.bin", gltf.buffer);
  document["buffers"] = {{{"byteLength", gltf.buffer.size()}, {"uri", "data%201.bin"}}};
  expect_unit_square(scene_of(import_scene(folder.write("a.gltf", document.dump()))));

  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string base64;
  ASSERT_EQ(gltf.buffer.size() % 3, 0u) << "no padding written here";
  for (size_t i = 0; i < gltf.buffer.size(); i += 3) {
    const auto byte = [&](size_t k) { return uint32_t(uint8_t(gltf.buffer[i + k])); };
    const uint32_t bits = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (const int shift : {18, 12, 6, 0}) base64 += kDigits[bits >> shift & 63];
  }
  document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64;
  expect_unit_square(scene_of(import_scene(folder.write("b.gltf", document.dump()))));
}

TEST(Gltf, MeshOfTwoNodesIsStoredOnceAndPlacedTwice) {
  Gltf gltf = square_gltf();
  gltf.json["nodes"][0]["name"] = "left";
  gltf.node({{"mesh", 0}, {"name", "right"}, {"translation", {5, 0, 0}}, {"scale", {2, 2, 2}}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[1].name, "right");
  EXPECT_NEAR(drawn_area(scene), 1 + 4, 1e-5f);
  expect_near(scene::world_bounds(scene).upper, {7, 2, 0}, 1e-6f);
}

// 90 degrees about z takes x to y; the parent then moves and the matrix form says the same.
TEST(Gltf, TransformsChainFromTheRoot) {
  const float h = std::sqrt(0.5f);
  Gltf gltf = square_gltf();
  gltf.json["nodes"] = {
      {{"translation", {10, 0, 0}}, {"children", {1, 2}}},
      {{"mesh", 0}, {"rotation", {0, 0, h, h}}, {"scale", {2, 3, 1}}},
      {{"mesh", 0}, {"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}};
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.instances.size(), 2u);
  for (const scene::Instance& instance : scene.instances) {
    expect_near(transform_point(instance.world_from_object, {1, 0, 0}), {10, 2, 0}, 1e-5f);
    expect_near(transform_point(instance.world_from_object, {0, 1, 0}), {7, 0, 0}, 1e-5f);
  }
}

// A node's own word, else its mesh's, else that of the nearest node above it; in luxel's object or,
// as Blender writes custom properties, flat. What is no such value is said and left out.
TEST(Gltf, ExtrasSayHowNodesLieInALightmap) {
  using nlohmann::json;
  Gltf gltf = square_gltf();
  gltf.json["meshes"].push_back(gltf.json["meshes"][0]);
  gltf.json["meshes"][0]["extras"] = {{"luxel", {{"density", 2}}}};
  gltf.json["nodes"] = {
      {{"children", {1, 2, 3, 4}}, {"extras", {{"luxel", {{"density", 4}, {"bake", false}}}}}},
      {{"mesh", 0}},
      {{"mesh", 0}, {"extras", {{"luxel_density", 0.5}, {"luxel_bake", 1}}}},
      {{"mesh", 1}},
      {{"mesh", 1}, {"name", "odd"}, {"extras", {{"luxel", {{"density", -1}, {"bake", "no"}}}}}}};
  const Result<Imported> imported = import_glb(gltf);
  ASSERT_TRUE(imported) << imported.error().message;
  const std::vector<scene::Instance>& in = imported->scene.instances;
  ASSERT_EQ(in.size(), 4u);
  const float densities[] = {2, 0.5f, 4, 4};
  const bool lightmapped[] = {false, true, false, false};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(in[i].texel_density, densities[i]) << i;
    EXPECT_EQ(in[i].lightmapped, lightmapped[i]) << i;
  }
  EXPECT_THAT(imported->warnings, testing::Contains(AllOf(HasSubstr("odd"), HasSubstr("density"))));
  EXPECT_THAT(imported->warnings, testing::Contains(AllOf(HasSubstr("odd"), HasSubstr("bake"))));
}

TEST(Gltf, MirroredInstanceKeepsItsFront) {
  Gltf gltf = square_gltf();
  gltf.json["nodes"][0]["scale"] = {-1, 1, 1};
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_LT(determinant(scene.instances[0].world_from_object), 0);
  expect_near(scene::front_normal(scene, 0, 0), {0, 0, 1}, 1e-6f);
}

TEST(Gltf, OnlyTheDefaultSceneIsDrawn) {
  Gltf gltf = square_gltf();
  gltf.json["nodes"].push_back({{"mesh", 0}, {"name", "other"}});
  gltf.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  gltf.json["scene"] = 1;
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].name, "other");
}

TEST(Gltf, GpuInstancingMultipliesTheNode) {
  Gltf gltf = square_gltf();
  const int t = gltf.floats({0, 0, 0, 0, 0, 3}, "VEC3", 3);
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = t;
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.instances.size(), 2u);
  expect_near(transform_point(scene.instances[1].world_from_object, {}), {0, 0, 3}, 1e-6f);
}

TEST(Gltf, PrimitivesMergeAndKeepTheirMaterials) {
  Gltf gltf = square_gltf();
  const int far = gltf.floats({0, 0, 1, 1, 0, 1, 1, 1, 1}, "VEC3", 3);
  const int normals = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  const int colors = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  gltf.json["materials"] = {{{"name", "m"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
  gltf.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", far}, {"NORMAL", normals}, {"COLOR_0", colors}}},
       {"material", 0}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.meshes.size(), 1u);
  const scene::Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangle_material, (std::vector<uint32_t>{1, 1, 0}));
  EXPECT_EQ(scene.materials[1].name, "default");
  // The part without normals is flat, that without colours is white.
  EXPECT_EQ(mesh.normals[mesh.triangles[0][0]], (Vec3{0, 0, 1}));
  EXPECT_EQ(mesh.colors[mesh.triangles[0][0]], (Rgb{1, 1, 1}));
  EXPECT_EQ(mesh.colors[mesh.triangles[2][0]], (Rgb{0, 0, 1}));
}

TEST(Gltf, PrimitivesThatShareVerticesStillShareThem) {
  Gltf gltf = square_gltf();
  const int second = gltf.add<uint16_t>({0, 2, 1}, 5123, "SCALAR", 1);
  gltf.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", 0}}}, {"indices", second}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 3u);
}

TEST(Gltf, LightsShineAlongMinusZOfTheirNode) {
  const float h = std::sqrt(0.5f);
  Gltf gltf = square_gltf();
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 20}, {"range", 9}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}}},
      {{"type", "directional"}, {"intensity", 3}}};
  for (int i = 0; i < 3; ++i)
    gltf.node({{"translation", {1, 2, 3}},
               {"rotation", {-h, 0, 0, h}},  // a quarter about -x: -z becomes -y
               {"scale", {4, 4, 4}},
               {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].kind, scene::PunctualLight::Kind::point);
  expect_near(scene.lights[0].intensity, {20, 10, 0}, 1e-5f);
  EXPECT_EQ(scene.lights[0].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(scene.lights[0].range_m, 9);
  EXPECT_EQ(scene.lights[1].kind, scene::PunctualLight::Kind::spot);
  expect_near(scene.lights[1].direction, {0, -1, 0}, 1e-6f);
  EXPECT_FLOAT_EQ(scene.lights[1].inner_cone_rad, 0.1f);
  EXPECT_FLOAT_EQ(scene.lights[1].outer_cone_rad, 0.3f);
  EXPECT_EQ(scene.lights[2].kind, scene::PunctualLight::Kind::directional);
  expect_near(scene.lights[2].intensity, {3, 3, 3}, 0);
  for (const scene::PunctualLight& light : scene.lights) {
    expect_near(light.direction, {0, -1, 0}, 1e-6f);
    expect_near(light.side, {1, 0, 0}, 1e-6f);  // the node's x, for profiles
  }
}

TEST(Gltf, SaysWhichNodesInstancesAndLightsComeFrom) {
  Gltf gltf = square_gltf();  // node 0
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"extras", {{"luxel", {{"angular_radius_rad", 0.005}}}}}},
      {{"type", "directional"}, {"extras", {{"luxel", {{"angular_radius_rad", "wide"}}}}}}};
  gltf.node({{"mesh", 0}, {"scale", {1, 0, 0}}});  // squashed flat: it is dropped
  gltf.node({{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  gltf.node({{"mesh", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const auto imported = import_glb(gltf);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(imported->node_of_instance, (std::vector<uint32_t>{0, 3}));
  EXPECT_EQ(imported->node_of_light, (std::vector<uint32_t>{2, 3}));
  EXPECT_EQ(imported->scene.lights[0].angular_radius_rad, 0);
  EXPECT_EQ(imported->scene.lights[1].angular_radius_rad, 0.005f);
}

TEST(Gltf, CamerasKeepTheirViewAndLoseTheirScale) {
  Gltf gltf = square_gltf();
  gltf.json["cameras"] = {
      {{"type", "perspective"},
       {"perspective", {{"yfov", 0.7}, {"aspectRatio", 1.5}, {"znear", 0.1}}}},
      {{"type", "orthographic"},
       {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}}};
  gltf.node({{"camera", 0}, {"name", "eye"}, {"translation", {0, 0, 5}}, {"scale", {3, 3, 3}}});
  gltf.node({{"camera", 1}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_FLOAT_EQ(scene.cameras[0].fov_y_rad, 0.7f);
  EXPECT_FLOAT_EQ(scene.cameras[0].aspect, 1.5f);
  expect_near(column(scene.cameras[0].world_from_camera, 3 - 1), {0, 0, 1}, 1e-6f);
  EXPECT_FLOAT_EQ(scene.cameras[1].orthographic_height_m, 4);
  EXPECT_FLOAT_EQ(scene.cameras[1].aspect, 1.5f);
}

// glTF 2.0, section 3.7.2.1: "When normals are not specified, client implementations must calculate
// flat normals". Whoever asks for others gets them.
TEST(Gltf, WithoutNormalsIsFlatUnlessAskedOtherwise) {
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 0, 0, 1, 1, 0, 0, -1, -0.2f, 0}, "VEC3", 3);
  const int indices = gltf.add<uint16_t>({0, 1, 2, 1, 0, 3}, 5123, "SCALAR", 1);
  gltf.draw({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const TemporaryFolder folder;
  const auto file = folder.write("a.glb", gltf.glb());
  EXPECT_TRUE(scene_of(import_scene(file)).meshes[0].normals.empty());
  EXPECT_EQ(scene_of(import_scene(file, {30.0f, {}})).meshes[0].normals.size(), 4u);
}

TEST(Gltf, AnErrorDoesNotPrintAWholeUri) {
  nlohmann::json document = square_gltf().json;
  document["buffers"] = {
      {{"byteLength", 60}, {"uri", "data:what/ever;base16," + std::string(200000, 'A')}}};
  const auto imported = import_text("a.gltf", document.dump());
  ASSERT_FALSE(imported);
  EXPECT_LT(imported.error().message.size(), 1000u);
}

}  // namespace
}  // namespace luxel::import
