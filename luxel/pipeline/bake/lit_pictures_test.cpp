#include "luxel/pipeline/bake/lit_pictures.h"

#include <gtest/gtest.h>

#include "luxel/image/color.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

constexpr Rgb kRho{0.8f, 0.4f, 0.2f};
constexpr float kSun = 3;

/// A floor of 4 x 4 m under a sun at the zenith: E is kSun everywhere, whatever the samples.
scene::Scene sunny_floor() {
  scene::Scene scene;
  scene::add_material(scene, "floor", kRho);
  scene::add_rectangle(scene, {0, 4, 0, 4}, 0, true, 0);
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.intensity = {kSun, kSun, kSun};
  scene.lights.push_back(sun);
  return scene;
}

/// Texture coordinates of `floor` that cover the texture once; 2 x 2 pixels, light and dark.
void add_checker(scene::Scene& scene) {
  scene::Texture texture;
  texture.width = texture.height = 2;
  for (const uint8_t v : {255, 0, 0, 255})
    texture.rgba.insert(texture.rgba.end(), {v, v, v, uint8_t(v == 0 ? 51 : 255)});
  scene.textures.push_back(texture);
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.filter = scene::Filter::nearest;
  for (const Vec3& p : scene.meshes[0].positions) scene.meshes[0].uv0.push_back({p.x / 4, p.z / 4});
}

BakeSettings lit_settings(export_::Attach attach) {
  BakeSettings settings;
  settings.resolution = 32, settings.samples = 1, settings.attach = attach;
  return settings;
}

struct Lit {
  Bake bake;
  export_::LitPictures pictures;
};
Lit lit(const scene::Scene& scene, const BakeSettings& settings, float exposure) {
  Progress progress;
  Result<Bake> bake = bake_scene(scene, settings, progress);
  EXPECT_TRUE(bake);
  bake->view.exposure = exposure;
  const auto pictures = lit_pictures(settings, *bake, progress);
  EXPECT_TRUE(pictures);
  return {std::move(*bake), *pictures};
}

int srgb8(float linear) {
  return int(255 * image::srgb_from_linear(std::min(linear, 1.0f)) + 0.5f);
}

/// Texels that lie on the floor have this colour.
void expect_color(const Lit& lit, Rgb expected) {
  const image::Image8& picture = lit.pictures.pages.at(0);
  const auto channels = size_t(picture.channels);
  for (const atlas::Texel& t : lit.bake.map.texels) {
    const size_t at = (size_t(t.y) * size_t(picture.width) + t.x) * channels;
    for (size_t c = 0; c < 3; ++c)
      ASSERT_NEAR(picture.data[at + c], srgb8(expected[int(c)]), 1) << t.x << " " << t.y;
  }
}

// Albedo times light times exposure: rho E / pi is 0.76 in red, so that half of it stays below the
// shoulder of the tone curve.
TEST(LitPictures, CombinedIsAlbedoTimesLightTimesExposure) {
  const Lit floor = lit(sunny_floor(), lit_settings(export_::Attach::combined), 0.5f);
  EXPECT_EQ(floor.pictures.scale, 1);
  EXPECT_EQ(floor.pictures.pages.at(0).channels, 3);
  EXPECT_EQ(floor.pictures.exposure, 0.5f);
  expect_color(floor, kRho * (0.5f * kSun / kPi));
}

// White of the emissive picture is `strength`, at most kMostStrength: red of 0.76 * 2 exposed asks
// for 1.53, that of 0.76 * 20 for more than there is, and clips.
TEST(LitPictures, EmissiveIsLinearUpToItsStrength) {
  const Lit bright = lit(sunny_floor(), lit_settings(export_::Attach::emissive), 2);
  EXPECT_NEAR(bright.pictures.strength, 2 * 0.8f * kSun / kPi, 1e-4f);
  expect_color(bright, kRho * (2 * kSun / kPi / bright.pictures.strength));
  const Lit clipped = lit(sunny_floor(), lit_settings(export_::Attach::emissive), 20);
  EXPECT_EQ(clipped.pictures.strength, kMostStrength);
  expect_color(clipped, kRho * (20 * kSun / kPi / kMostStrength));
  const Lit dim = lit(sunny_floor(), lit_settings(export_::Attach::emissive), 0.5f);
  EXPECT_EQ(dim.pictures.strength, 1) << "without the extension, where nothing exceeds white";
}

// A texture of 256 pixels on some 28 texels wants 16 pixels a texel; 32 x 8 is the most here.
TEST(LitPictures, AreFineEnoughForTextures) {
  scene::Scene scene = sunny_floor();
  add_checker(scene);
  Progress progress;
  const auto bake = bake_scene(scene, lit_settings(export_::Attach::combined), progress);
  ASSERT_TRUE(bake);
  scene::Scene fine = bake->scene;
  EXPECT_EQ(picture_scale(fine, bake->atlas, 4096), 1) << "2 pixels";
  fine.textures[0].width = fine.textures[0].height = 256;
  EXPECT_EQ(picture_scale(fine, bake->atlas, 4096), 16);
  EXPECT_EQ(picture_scale(fine, bake->atlas, 256), 8);
  fine.materials[0].base_color_texture.scale = {4, 4};  // repeated: four times as fine
  EXPECT_EQ(picture_scale(fine, bake->atlas, 4096), 64);
  fine.materials[0].unlit = true;
  EXPECT_EQ(picture_scale(fine, bake->atlas, 4096), 1);
}

// The quarters of the texture where they lie on the floor, at 8 pixels per texel; holes of a mask
// are those of the texture.
TEST(LitPictures, HoldTexturesAndTheirAlpha) {
  scene::Scene scene = sunny_floor();
  add_checker(scene);
  scene::Texture& texture = scene.textures[0];
  std::vector<uint8_t> fine;  // the same quarters in 200 x 200 pixels
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      for (int c = 0; c < 4; ++c)
        fine.push_back(texture.rgba[size_t(4 * (x / 100 + 2 * (y / 100)) + c)]);
  texture.rgba = fine, texture.width = texture.height = 200;
  scene.materials[0].alpha_mode = scene::AlphaMode::mask;
  scene.materials[0].alpha_cutoff = 0.1f;  // keeps all of it
  const Lit lit_floor = lit(scene, lit_settings(export_::Attach::combined), 0.5f);
  ASSERT_EQ(lit_floor.pictures.scale, 8);
  const image::Image8& picture = lit_floor.pictures.pages.at(0);
  ASSERT_EQ(picture.channels, 4);
  ASSERT_EQ(picture.width, 256);
  int seen = 0;
  for (int i = 0; i < 64; ++i) {
    const Vec2 at{float(i % 8) * 0.5f + 0.25f, float(i / 8) * 0.5f + 0.25f};  // on the floor [m]
    for (uint32_t t = 0; t < 2; ++t) {
      const auto& triangle = lit_floor.bake.scene.meshes[0].triangles[t];
      const auto xz = [&](size_t c) {
        const Vec3 p = lit_floor.bake.scene.meshes[0].positions[triangle[c]];
        return Vec2{p.x, p.z};
      };
      const Barycentric b = atlas::barycentric_in({xz(0), xz(1), xz(2)}, at);
      if (b.u < 0 || b.v < 0 || b.u + b.v > 1) continue;
      const auto& c = lit_floor.bake.atlas.corners[t];
      const Vec2 place = interpolate(c[0], c[1], c[2], b) * 8;
      const size_t pixel = 4 * (size_t(place.y) * 256 + size_t(place.x));
      const bool light = (at.x < 2) == (at.y < 2);
      const Rgb expected = light ? kRho * (0.5f * kSun / kPi) : Rgb{};
      for (size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(picture.data[pixel + k], srgb8(expected[int(k)]), 1) << at.x << " " << at.y;
      EXPECT_NEAR(picture.data[pixel + 3], light ? 255 : 51, 1);
      ++seen;
    }
  }
  EXPECT_GE(seen, 64);
}

}  // namespace
}  // namespace luxel::pipeline
