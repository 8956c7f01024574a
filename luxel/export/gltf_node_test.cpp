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

TEST(SceneGlb, CamerasAreKept) {
  const Document d = parse(*scene_glb(rich_scene()));
  ASSERT_EQ(d.j["cameras"].size(), 2u);
  EXPECT_EQ(d.j["cameras"][0]["perspective"]["yfov"], 0.8f);
  EXPECT_EQ(d.j["cameras"][0]["perspective"]["aspectRatio"], 1.5f);
  EXPECT_EQ(d.j["cameras"][1]["orthographic"]["ymag"], 2.0f);
}

}  // namespace
}  // namespace luxel::export_
