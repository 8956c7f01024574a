// Skins and morph targets: vertices where the file's own pose puts them.
#include <gmock/gmock.h>

#include "luxel/import/import_test_support.h"

namespace luxel::import {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A square of two joints. Joint 0 moves by (0, 1, 0), joint 1 by (0, 3, 0) after it has doubled
/// the size around (1, 0, 0). Corner 0 hangs on joint 0, corner 1 on joint 1, corner 2 a quarter on
/// joint 0 and the rest on joint 1, corner 3 on none. The node that draws it is 100 times as large.
struct Figure {
  Gltf gltf;
  json primitive = {{"attributes", json::object()}};

  Figure() {
    primitive["attributes"]["POSITION"] = gltf.floats(square_corners(), "VEC3", 3);
    primitive["indices"] = gltf.add<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
    gltf.node({{"name", "joint a"}, {"translation", {0, 1, 0}}});
    gltf.node({{"name", "joint b"}, {"translation", {0, 3, 0}}, {"scale", {2, 2, 2}}});
    const int bind = gltf.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,  //
                                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                 "MAT4", 16);
    gltf.json["skins"] = {{{"name", "bones"}, {"joints", {0, 1}}, {"inverseBindMatrices", bind}}};
  }
  void joints(int set, const std::vector<uint8_t>& joints) {
    primitive["attributes"][fmt::format("JOINTS_{}", set)] = gltf.add(joints, 5121, "VEC4", 4);
  }
  void weights(int set, int accessor) {
    primitive["attributes"][fmt::format("WEIGHTS_{}", set)] = accessor;
  }
  /// Draws it by node 2.
  Result<Imported> import() {
    gltf.json["meshes"].push_back({{"name", "body"}, {"primitives", {primitive}}});
    gltf.node({{"mesh", 0}, {"skin", 0}, {"scale", {100, 100, 100}}, {"translation", {0, 0, 7}}});
    return import_glb(gltf);
  }
};

const std::vector<uint8_t> kJoints = {0, 9, 9, 9, 1, 9, 9, 9, 0, 1, 9, 9, 0, 0, 0, 0};
const std::vector<float> kWeights = {1, 0, 0, 0, 1, 0, 0, 0, 0.25f, 0.75f, 0, 0, 0, 0, 0, 0};

void expect_figure(const Result<Imported>& imported, float tolerance) {
  const scene::Scene scene = scene_of(imported);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].world_from_object, Mat34{});
  const std::vector<Vec3>& at = scene.meshes[scene.instances[0].mesh].positions;
  ASSERT_EQ(at.size(), 4u);
  const Vec3 expected[] = {{0, 1, 0}, {0, 3, 0}, {0.25f, 4.25f, 0}, {0, 100, 7}};
  for (size_t i = 0; i < 4; ++i)
    EXPECT_LE(length(at[i] - expected[i]), tolerance)
        << i << ": " << at[i].x << ' ' << at[i].y << ' ' << at[i].z;
  EXPECT_EQ(all_of(imported->warnings), "");
}

TEST(Skin, JointsPlaceTheVerticesWhateverTheirNodeSays) {
  Figure figure;
  figure.joints(0, kJoints);
  figure.weights(0, figure.gltf.floats(kWeights, "VEC4", 4));
  expect_figure(figure.import(), 1e-6f);
}

TEST(Skin, WeightsMayBeWholeNumbers) {
  Figure bytes;
  bytes.joints(0, kJoints);
  bytes.weights(0, bytes.gltf.add<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 64, 191, 0, 0, 0, 0, 0, 0},
                                           5121, "VEC4", 4, true));
  expect_figure(bytes.import(), 0.005f);
  Figure shorts;
  shorts.joints(0, kJoints);
  shorts.weights(
      0, shorts.gltf.add<uint16_t>({65535, 0, 0, 0, 65535, 0, 0, 0, 16384, 49151, 0, 0, 0, 0, 0, 0},
                                   5123, "VEC4", 4, true));
  expect_figure(shorts.import(), 1e-4f);
}

TEST(Skin, WeightsOfTwoSetsNeedNotAddUpToOne) {
  Figure figure;
  figure.joints(0, {0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  figure.weights(
      0, figure.gltf.floats({0.5f, 0, 0, 0, 3, 0, 0, 0, 0.125f, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4));
  figure.joints(1, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0});
  figure.weights(
      1, figure.gltf.floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.375f, 0, 0, 0, 0, 0}, "VEC4", 4));
  expect_figure(figure.import(), 1e-6f);
}

TEST(Skin, WithoutBindMatricesTheJointsAlonePlaceThem) {
  Figure figure;
  figure.joints(0, std::vector<uint8_t>(16, 1));
  figure.weights(0, figure.gltf.floats(std::vector<float>(16, 0.25f), "VEC4", 4));
  figure.gltf.json["skins"][0].erase("inverseBindMatrices");
  const scene::Scene scene = scene_of(figure.import());
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_NEAR(drawn_area(scene), 4, 1e-5f);
  EXPECT_EQ(scene::world_bounds(scene).lower, (Vec3{0, 3, 0}));
}

TEST(Skin, AJointThatMirrorsKeepsTheFront) {
  for (const bool normals : {false, true}) {
    Figure figure;
    figure.joints(0, std::vector<uint8_t>(16, 0));
    figure.weights(0, figure.gltf.floats(std::vector<float>(16, 1), "VEC4", 4));
    if (normals)
      figure.primitive["attributes"]["NORMAL"] =
          figure.gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    figure.gltf.json["nodes"][0]["scale"] = {-1, 1, 1};
    const scene::Scene scene = scene_of(figure.import());
    ASSERT_EQ(scene.instances.size(), 1u);
    const scene::Mesh& mesh = scene.meshes[scene.instances[0].mesh];
    for (const auto& [a, b, c] : mesh.triangles)
      EXPECT_EQ(normalize(scene::geometric_normal_area2(
                    {mesh.positions[a], mesh.positions[b], mesh.positions[c]})),
                (Vec3{0, 0, 1}));
    for (const Vec3 n : mesh.normals) EXPECT_EQ(n, (Vec3{0, 0, 1}));
    EXPECT_EQ(mesh.normals.size(), normals ? 4u : 0u);
  }
}

TEST(Skin, AMeshMayBeDrawnWithItAndWithout) {
  Figure figure;
  figure.joints(0, kJoints);
  figure.weights(0, figure.gltf.floats(kWeights, "VEC4", 4));
  figure.gltf.node({{"mesh", 0}, {"translation", {50, 0, 0}}});
  const scene::Scene scene = scene_of(figure.import());
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].mesh, 0u);
  EXPECT_EQ(scene.meshes[0].positions[2], (Vec3{1, 1, 0})) << "where the node puts it";
  EXPECT_EQ(scene.meshes[scene.instances[1].mesh].positions[1], (Vec3{0, 3, 0}));
}

TEST(Skin, ErrorsNameThePlace) {
  const auto error_with = [](const auto& damage) {
    Figure figure;
    figure.joints(0, kJoints);
    figure.weights(0, figure.gltf.floats(kWeights, "VEC4", 4));
    damage(figure);
    return error_of(figure.import());
  };
  EXPECT_EQ(error_with([](Figure&) {}), "no error");
  EXPECT_THAT(error_with([](Figure& f) { f.joints(0, std::vector<uint8_t>(16, 7)); }),
              HasSubstr("mesh 0 (body), primitive 0, JOINTS_0: joint 7 is out of range, the skin "
                        "has 2"));
  EXPECT_THAT(error_with([](Figure& f) { f.primitive["attributes"].erase("WEIGHTS_0"); }),
              HasSubstr("has only one of JOINTS_0 and WEIGHTS_0"));
  EXPECT_THAT(error_with([](Figure& f) { f.joints(0, std::vector<uint8_t>(12, 0)); }),
              HasSubstr("JOINTS_0: 3 values for 4 positions"));
  EXPECT_THAT(error_with([](Figure& f) {
                f.gltf.json["skins"][0]["joints"] = {0, 1, 0};
              }),
              HasSubstr("skin 0 (bones): 2 inverse bind matrices for 3 joints"));
  EXPECT_THAT(error_with([](Figure& f) {
                f.gltf.json["skins"][0]["joints"] = {0, 17};
              }),
              HasSubstr("skin 0 (bones): joints 17 is out of range"));
  EXPECT_THAT(error_with([](Figure& f) { f.gltf.json["skins"][0].erase("joints"); }),
              HasSubstr("skin 0 (bones): it has no joints"));
  EXPECT_THAT(error_with([](Figure& f) { f.gltf.json["skins"][0]["inverseBindMatrices"] = 0; }),
              HasSubstr("inverseBindMatrices: accessor 0 has 3 numbers per element, must be 16"));
}

/// A square whose targets move it up by 1 m, and to the side by 2 m.
Gltf lid(const json& mesh_weights) {
  Gltf gltf = square_gltf();
  json& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive["targets"] = {
      {{"POSITION", gltf.floats({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3", 3)}},
      {{"POSITION", gltf.floats({2, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0}, "VEC3", 3)}}};
  if (!mesh_weights.is_null()) gltf.json["meshes"][0]["weights"] = mesh_weights;
  return gltf;
}

Vec3 lower_of(const Gltf& gltf) {
  const Result<Imported> imported = import_glb(gltf);
  EXPECT_TRUE(imported && imported->warnings.empty());
  return scene::world_bounds(scene_of(imported)).lower;
}

TEST(MorphTargets, TheWeightsOfTheFileAreApplied) {
  EXPECT_EQ(lower_of(lid(nullptr)), (Vec3{0, 0, 0}));
  EXPECT_EQ(lower_of(lid({1, 0})), (Vec3{0, 1, 0}));
  EXPECT_EQ(lower_of(lid({0.5, 0.25})), (Vec3{0.5f, 0.5f, 0}));
  Gltf own = lid({1, 0});
  own.json["nodes"][0]["weights"] = {0, 1};
  EXPECT_EQ(lower_of(own), (Vec3{2, 0, 0})) << "a node's weights replace those of its mesh";
}

TEST(MorphTargets, NodesOfEqualWeightsShareOneMesh) {
  Gltf gltf = lid({1, 0});
  for (const double weight : {0.0, 0.5, 0.5}) gltf.node({{"mesh", 0}, {"weights", {weight, 0.0}}});
  const scene::Scene scene = scene_of(import_glb(gltf));
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[2].mesh, scene.instances[3].mesh);
  EXPECT_EQ(scene.meshes.size(), 3u);
  for (const auto& [instance, y] : {std::pair{0, 1.0f}, {1, 0.0f}, {2, 0.5f}})
    EXPECT_EQ(scene.meshes[scene.instances[size_t(instance)].mesh].positions[0].y, y);
}

TEST(MorphTargets, NormalsTurnWithThem) {
  Gltf gltf = lid({0.5, 0});
  json& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = gltf.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  primitive["targets"][0]["NORMAL"] = gltf.floats({0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0}, "VEC3", 3);
  const scene::Scene scene = scene_of(import_glb(gltf));
  EXPECT_LE(length(scene.meshes[0].normals[0] - normalize(Vec3{0, 1, 1})), 1e-6f);
}

TEST(MorphTargets, ErrorsNameThePlace) {
  Gltf far = lid({1, 0});
  far.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 99;
  EXPECT_THAT(error_of(import_glb(far)), HasSubstr("POSITION 99 is out of range"));
  Gltf list = lid({1, 0});
  list.json["meshes"][0]["primitives"][0]["targets"] = 3;
  EXPECT_THAT(error_of(import_glb(list)), HasSubstr("targets is not a list"));
  Gltf few = lid({1, 0});
  few.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] =
      few.floats({0, 1, 0}, "VEC3", 3);
  EXPECT_THAT(error_of(import_glb(few)),
              HasSubstr("morph target 0, POSITION: 1 values for 4 positions"));
}

}  // namespace
}  // namespace luxel::import
