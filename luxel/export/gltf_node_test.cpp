// Lights and cameras in the files that export writes.
#include "luxel/export/gltf_node.h"

#include <gtest/gtest.h>

#include "luxel/export/baked_glb.h"
#include "luxel/export/glb_test_support.h"
#include "luxel/export/scene_test_support.h"

namespace luxel::export_ {
namespace {

TEST(SceneGlb, LightsShineAlongTheirDirection) {
  const scene::Scene scene = rich_scene();
  const Document d = parse(*scene_glb(scene));
  const json& lights = d.j["extensions"]["KHR_lights_punctual"]["lights"];
  ASSERT_EQ(lights.size(), 3u);
  for (const json& node : d.j["nodes"]) {
    if (!node.contains("extensions")) continue;
    const size_t index = node["extensions"]["KHR_lights_punctual"]["light"];
    const scene::PunctualLight& light = scene.lights[index];
    const json& read = lights[index];
    const Mat34 m = local_matrix(node);
    if (index > 0) expect_close(transform_vector(m, {0, 0, -1}), light.direction, 1e-6f);
    expect_close(transform_point(m, {}), light.position, 1e-6f);
    for (size_t c = 0; c < 3; ++c)
      EXPECT_FLOAT_EQ(read["color"][c].get<float>() * read["intensity"].get<float>(),
                      light.intensity[int(c)]);
  }
  EXPECT_EQ(lights[0]["range"], 7.0f);
  EXPECT_EQ(lights[1]["type"], "spot");
  EXPECT_FLOAT_EQ(lights[1]["spot"]["outerConeAngle"].get<float>(), kPi / 4);
  EXPECT_EQ(lights[2]["type"], "directional");
}

// 100 cos v below, dark above: a quarter over all directions, (1 + cos a) / 2 over a cone of a.
/// A million lamps of one kind: one entry, and for each a node with three numbers.
TEST(SceneGlb, EqualLightsShareTheirEntry) {
  scene::Scene scene = rich_scene();
  scene.cameras.clear();
  scene.lights.assign(5, {});
  for (size_t k = 0; k < scene.lights.size(); ++k) scene.lights[k].position = {float(k), 2, 3};
  scene.lights.back().intensity = {7, 7, 7};
  const Document d = parse(*scene_glb(scene));
  EXPECT_EQ(d.j["extensions"]["KHR_lights_punctual"]["lights"].size(), 2u);
  size_t lamps = 0;
  for (const json& node : d.j["nodes"]) {
    if (!node.contains("extensions")) continue;
    EXPECT_EQ(node["translation"], json({float(lamps), 2.0f, 3.0f}));
    EXPECT_EQ(node["extensions"]["KHR_lights_punctual"]["light"], lamps == 4 ? 1 : 0);
    ++lamps;
  }
  EXPECT_EQ(lamps, 5u);
}

TEST(SceneGlb, LampsWithProfilesGetTheirMean) {
  scene::Scene scene = rich_scene();
  scene::LightProfile plate;
  plate.horizontal_rad = {0};
  for (int v = 0; v <= 90; ++v) {
    plate.vertical_rad.push_back(float(v) * kPi / 180);
    plate.candela.push_back(100 * std::max(0.0f, std::cos(plate.vertical_rad.back())));
  }
  for (size_t i : {0, 1}) scene::attach_profile(scene, i, plate, 2);
  scene.lights[1].outer_cone_rad = 0.5f;
  const Document d = parse(*scene_glb(scene));
  const json& lights = d.j["extensions"]["KHR_lights_punctual"]["lights"];
  // Interpolation between degrees loses 2.5e-5 of a cosine.
  EXPECT_NEAR(lights[0]["intensity"].get<float>(), 2 * 25, 5e-3f);
  EXPECT_NEAR(lights[1]["intensity"].get<float>(), 100 * (1 + std::cos(0.5f)), 2e-2f);
  EXPECT_EQ(lights[1]["type"], "spot");
}

// All of the scene moves by its origin, in double precision, and nothing else changes.
TEST(SceneGlb, NodesStandInTheWorldOfTheFile) {
  scene::Scene scene = rich_scene();
  const json near = parse(*scene_glb(scene)).j;
  scene.origin = {512344, 88, -5403208};
  const json far = parse(*scene_glb(scene)).j;
  const auto place_of = [](const json& node) -> DVec3 {
    if (node.contains("matrix"))
      return {node["matrix"][12], node["matrix"][13], node["matrix"][14]};
    const json at = node.value("translation", json{0, 0, 0});
    return {at[0], at[1], at[2]};
  };
  std::set<size_t> inner;
  ASSERT_EQ(far["nodes"].size(), near["nodes"].size());
  for (const json& node : far["nodes"])
    for (const json& child : node.value("children", json::array()))
      inner.insert(child.get<size_t>());
  EXPECT_FALSE(inner.empty());  // sheared instances stand in a node that has the place
  for (size_t i = 0; i < far["nodes"].size(); ++i) {
    json a = near["nodes"][i], b = far["nodes"][i];
    const DVec3 moved = inner.contains(i) ? DVec3{} : scene.origin;
    EXPECT_EQ(place_of(b), place_of(a) + moved) << b;
    for (json* node : {&a, &b}) {
      node->erase("translation");
      for (size_t k = 12; k < 15 && node->contains("matrix"); ++k) (*node)["matrix"].erase(12);
    }
    EXPECT_EQ(a, b);
  }
  EXPECT_EQ(near["accessors"], far["accessors"]);
}

TEST(SceneGlb, CamerasAreKept) {
  const Document d = parse(*scene_glb(rich_scene()));
  ASSERT_EQ(d.j["cameras"].size(), 2u);
  EXPECT_EQ(d.j["cameras"][0]["perspective"]["yfov"], 0.8f);
  EXPECT_EQ(d.j["cameras"][0]["perspective"]["aspectRatio"], 1.5f);
  EXPECT_EQ(d.j["cameras"][1]["orthographic"]["ymag"], 2.0f);
}

}  // namespace
}  // namespace luxel::export_
