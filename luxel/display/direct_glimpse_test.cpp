#include "luxel/display/direct_glimpse.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/scene/procedural.h"

namespace luxel::display {
namespace {

scene::PunctualLight lamp(float x, float intensity) {
  scene::PunctualLight light;
  light.position = {x, 1, 0};
  light.intensity = {intensity, intensity, intensity};
  return light;
}

bool has_source_at(const Glimpse& glimpse, float x) {
  return std::ranges::any_of(
      glimpse.sources, [&](const Glimpse::Source& s) { return !s.is_direction && s.at.x == x; });
}

TEST(Glimpse, HasEveryLightThatShinesOfAFew) {
  scene::Scene scene = scene::cornell_box();
  const size_t before = glimpse_of(scene).sources.size();
  for (int k = 0; k < 256; ++k) scene.lights.push_back(lamp(float(k), k == 7 ? 0.0f : 1.0f));
  EXPECT_EQ(glimpse_of(scene).sources.size(), before + 255);
}

/// A view is chosen by looking from thousands of places towards each source: of a million lights
/// some hundred stand for all, from everywhere among them, and one that matters is among them.
TEST(Glimpse, HasSomeOfManyLightsAndTheBrightOnes) {
  scene::Scene scene = scene::cornell_box();
  const size_t before = glimpse_of(scene).sources.size();
  for (int k = 0; k < 100000; ++k) scene.lights.push_back(lamp(float(k), 0.001f));
  scene.lights.insert(scene.lights.begin() + 31415, lamp(-5, 1));  // a hundredth of all
  const Glimpse glimpse = glimpse_of(scene);
  EXPECT_LE(glimpse.sources.size(), before + 256);
  EXPECT_GE(glimpse.sources.size(), before + 250);
  EXPECT_TRUE(has_source_at(glimpse, -5));
  for (int part = 0; part < 10; ++part)
    EXPECT_GE(std::ranges::count_if(glimpse.sources,
                                    [&](const Glimpse::Source& s) {
                                      return s.at.x >= float(10000 * part) &&
                                             s.at.x < float(10000 * (part + 1));
                                    }),
              20)
        << part;
  // A sun of 1 W/m^2 brings more than all of them.
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  scene.lights.push_back(sun);
  const auto with_sun = glimpse_of(scene).sources;
  EXPECT_TRUE(std::ranges::any_of(with_sun, &Glimpse::Source::is_direction));
}

}  // namespace
}  // namespace luxel::display
