#include "luxel/light/light_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/light/layer_instances.h"
#include "luxel/scene/shapes.h"

namespace luxel::light {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void add_lamp(scene::Scene& scene, const std::string& name, float power = 1) {
  scene.lights.emplace_back();
  scene.lights.back().name = name, scene.lights.back().intensity = Rgb{1, 1, 1} * power;
}

void add_panel(scene::Scene& scene, const std::string& name, uint32_t material, float y) {
  scene::add_rectangle(scene, {0, 1, 0, 1}, y, false, material);
  scene.instances.back().name = name;
}

std::vector<std::string> names_of(const LightLayers& layers) {
  std::vector<std::string> names;
  for (const LightLayer& layer : layers.layers) names.push_back(layer.name);
  return names;
}

LightLayers layers_of(const scene::Scene& scene, LayerMode mode) {
  const auto layers = light_layers(scene, collect_lights(scene), mode);
  EXPECT_TRUE(layers) << layers.error().message;
  return *layers;
}

scene::Scene shop() {
  scene::Scene scene;
  const uint32_t tube = scene::add_material(scene, "Tube.001", {}, {1, 1, 1});
  const uint32_t sign = scene::add_material(scene, "sign", {}, {1, 0, 0});
  const uint32_t wall = scene::add_material(scene, "wall", {0.5f, 0.5f, 0.5f});
  add_lamp(scene, "lamp.001"), add_lamp(scene, "lamp.002"), add_lamp(scene, "off", 0);
  add_lamp(scene, ""), add_lamp(scene, "Lamp 3");
  add_panel(scene, "floor", wall, 0);
  add_panel(scene, "tube a", tube, 3), add_panel(scene, "tube b", tube, 2.9f);
  add_panel(scene, "lamp.001", sign, 2);
  scene.background = {0.1f, 0.1f, 0.1f};
  return scene;
}

// Lamps, then what shines, then the sky; what sends nothing has none; names that differ only in
// case, or not at all, get a number; spaces are no part of a file's name.
TEST(LightLayers, EachLightHasItsOwn) {
  const scene::Scene scene = shop();
  const LightLayers layers = layers_of(scene, LayerMode::per_light);
  EXPECT_THAT(names_of(layers), ElementsAre("lamp.001", "lamp.002", "light_4", "Lamp_3", "tube_a",
                                            "tube_b", "lamp.001-2", "sky"));
  EXPECT_THAT(layers.layers[3].lights, ElementsAre("Lamp 3"));
  EXPECT_EQ(layers.of_punctual[4], 3);
  EXPECT_EQ(layers.of_surroundings, 7);
  const Lights lights = collect_lights(scene);
  EXPECT_THAT(instances_of_layers(lights, layers)[4], ElementsAre(1));
  ASSERT_EQ(layers.of_triangle.size(), lights.triangles.size());
  for (size_t k = 0; k < lights.triangles.size(); ++k)
    EXPECT_EQ(layers.of_triangle[k], 3 + lights.triangles[k].instance);  // instance 1 is layer 4
}

TEST(LightLayers, GroupsGoByNamesWithoutNumbers) {
  const LightLayers layers = layers_of(shop(), LayerMode::groups);
  EXPECT_THAT(names_of(layers), ElementsAre("lamp", "light", "Lamp-2", "Tube", "sign", "sky"));
  EXPECT_THAT(layers.layers[0].lights, ElementsAre("lamp.001", "lamp.002"));
  EXPECT_THAT(layers.layers[3].lights, ElementsAre("tube a", "tube b"));
  const auto instances = instances_of_layers(collect_lights(shop()), layers);
  EXPECT_THAT(instances[3], ElementsAre(1, 2));
  EXPECT_TRUE(instances[5].empty());
  for (const auto& [name, without] : {std::pair{"lamp.001", "lamp"},
                                      {"lamp_2", "lamp"},
                                      {"lamp 3", "lamp"},
                                      {"lamp12", "lamp"},
                                      {"lamp", "lamp"},
                                      {"lamp.", "lamp."},
                                      {"2nd lamp", "2nd lamp"},
                                      {"007", "007"},
                                      {"", ""}})
    EXPECT_EQ(without_number(name), without);
}

TEST(LightLayers, TooManyAreRefused) {
  scene::Scene scene;
  for (int k = 0; k < 65; ++k) add_lamp(scene, fmt::format("{}{}", k < 40 ? "a" : "b", k));
  const auto layers = light_layers(scene, collect_lights(scene), LayerMode::per_light);
  ASSERT_FALSE(layers);
  EXPECT_THAT(layers.error().message, HasSubstr("makes 65 layers"));
  EXPECT_THAT(layers.error().message, HasSubstr("--layers groups makes 2"));
  scene.lights.pop_back();
  EXPECT_EQ(layers_of(scene, LayerMode::per_light).size(), 64u);
}

// Channels are scaled apart; where no layer has light there is nothing to scale.
TEST(LightLayers, ShareOutMakesTheSumWhole) {
  std::vector<Rgb> own{{1, 2, 0}, {3, 2, 0}};
  const Rgb missing = share_out({8, 2, 1}, own);
  EXPECT_EQ(missing, (Rgb{4, -2, 1}));
  EXPECT_EQ(own[0], (Rgb{2, 1, 0}));
  EXPECT_EQ(own[1], (Rgb{6, 1, 0}));
  std::vector<Rgb> faint{{1e-38f, 0, 0}};
  share_out({1e5f, 1, 1}, faint);
  EXPECT_EQ(faint[0], (Rgb{1e-38f, 0, 0}));
}

}  // namespace
}  // namespace luxel::light
