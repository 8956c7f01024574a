// Sums of layers whose light is known.
#include "luxel/view/model/layers.h"

#include <gmock/gmock.h>

#include "luxel/view/model/events.h"

namespace luxel::view {
namespace {

using ::testing::HasSubstr;

/// Two layers of two pages: texel x has the light (x, 1, 2) of the first and (10, 20, 30) of the
/// second.
struct TwoLayers {
  Layers layers;
  pipeline::LightmapPages lightmaps;

  TwoLayers() {
    layers.layers.resize(2);
    layers.layers[0].name = "lamp", layers.layers[1].name = "sky";
    for (int page = 0; page < 2; ++page) {
      image::Image a(4, 1, 4), b(4, 1, 3), sum(4, 1, 4);
      for (int x = 0; x < 4; ++x) {
        a.set_rgb(x, 0, {float(x), 1, 2}), b.set_rgb(x, 0, {10, 20, 30});
        sum.set_rgb(x, 0, a.rgb(x, 0) + b.rgb(x, 0));
        sum.at(x, 0)[3] = 0.5f;
      }
      layers.layers[0].pages.push_back(a), layers.layers[1].pages.push_back(b);
      lightmaps.pictures.push_back(sum);
    }
    lightmaps.of_material = {0, 1};
  }
};

TEST(Layers, AddUpByTheirSettings) {
  const TwoLayers two;
  const std::vector<LayerSetting> settings{{"lamp", 0.5f, {1, 2, 4}}, {"sky", 0, {1, 1, 1}}};
  for (const size_t count : {1, 2}) {
    const auto mixed = mixed_light(two.layers, std::span(settings).first(count), two.lightmaps);
    ASSERT_TRUE(mixed) << mixed.error().message;
    ASSERT_EQ(mixed->size(), 2u);
    const Rgb sky = count == 1 ? Rgb{10, 20, 30} : Rgb{};
    for (const image::Image& page : *mixed)
      for (int x = 0; x < 4; ++x) {
        EXPECT_EQ(page.rgb(x, 0), sky + Rgb({0.5f * float(x), 1, 4}));
        EXPECT_EQ(page.at(x, 0)[3], 0.5f);
      }
  }
  const auto as_baked = mixed_light(two.layers, {}, two.lightmaps);
  ASSERT_TRUE(as_baked);
  EXPECT_EQ(as_baked->front().data, two.lightmaps.pictures.front().data);
}

TEST(Layers, SettingsReplaceOneAnother) {
  std::vector<LayerSetting> settings;
  set_layer({"a", 2, {1, 1, 1}}, settings);
  set_layer({"b", 0, {1, 1, 1}}, settings);
  set_layer({"a", 3, {1, 0, 1}}, settings);
  EXPECT_EQ(settings.size(), 2u);
  EXPECT_EQ(factor_of(settings, "a"), (Rgb{3, 0, 3}));
  EXPECT_EQ(factor_of(settings, "c"), (Rgb{1, 1, 1}));
  set_layer({"a"}, settings);
  EXPECT_EQ(settings, (std::vector<LayerSetting>{{"b", 0, {1, 1, 1}}})) << "as it was baked";
}

TEST(Layers, UnknownOnesAreNamed) {
  const TwoLayers two;
  const std::vector<LayerSetting> settings{{"moon", 2, {1, 1, 1}}};
  const auto mixed = mixed_light(two.layers, settings, two.lightmaps);
  ASSERT_FALSE(mixed);
  EXPECT_EQ(mixed.error().message, "there is no layer 'moon'; there are lamp, sky");
  EXPECT_THAT(mixed_light({}, settings, two.lightmaps).error().message,
              HasSubstr("bake with --layers"));
}

TEST(Layers, AreSetByEvents) {
  const auto event = [](const std::string& layer) {
    return parse_play(R"({"end": 0, "events": [{"at": 0, "layer": )" + layer + "}]}", "p.json");
  };
  const auto play = event(R"({"name": "lamp", "dimmer": 0.5, "color": [1, 0.5, 0]})");
  ASSERT_TRUE(play) << play.error().message;
  const auto& changed = std::get<LayerChanged>(play->events.front().event);
  EXPECT_EQ(changed.setting, (LayerSetting{"lamp", 0.5f, {1, 0.5f, 0}}));
  EXPECT_TRUE(event(R"({"name": "lamp"})"));
  for (const char* wrong :
       {R"({"name": "lamp", "dimmer": -1})", R"({"dimmer": 1})", "{}", "7",
        R"({"name": "lamp", "color": [1, 1]})", R"({"name": "lamp", "color": [1, 1, -1]})"})
    EXPECT_FALSE(event(wrong)) << wrong;
}

}  // namespace
}  // namespace luxel::view
