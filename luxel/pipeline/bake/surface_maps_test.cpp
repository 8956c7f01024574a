#include "luxel/pipeline/bake/surface_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "luxel/base/vec_double.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

using testing::HasSubstr;

/// A floor of 4 x 4 m, and on its side x = 0 a wall of `height_m` that faces it, 4 m long.
scene::Scene floor_and_wall(float height_m) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {0, 4, 0, 4}, 0, true, 0);
  scene::Mesh wall;
  wall.name = "wall";
  scene::add_quad(wall, {Vec3{0, 0, 0}, {0, height_m, 0}, {0, height_m, 4}, {0, 0, 4}}, 0);
  scene::place(scene, std::move(wall));
  return scene;
}

/// A sun that shines from above the wall towards +x, 45 degrees high.
void add_sun(scene::Scene& scene, float angular_radius_rad) {
  scene::PunctualLight sun;
  sun.name = "sun", sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3{1, -1, 0});
  sun.angular_radius_rad = angular_radius_rad;
  scene.lights.push_back(sun);
}

/// A map's values on the floor, with where they are.
struct OnFloor {
  Vec3 at;
  Rgb value;
};
struct Maps {
  Bake bake;
  std::vector<OnFloor> on_floor(size_t map, size_t array = 0) const {
    std::vector<OnFloor> out;
    for (size_t i = 0; i < bake.map.texels.size(); ++i)
      if (bake.map.texels[i].sample.instance == 0 && bake.map.texels[i].centre_covered)
        out.push_back({scene::world_position(bake.scene, bake.map.texels[i].sample),
                       bake.surface_maps.at(map).values.at(array)[i]});
    return out;
  }
};
Maps maps_of(scene::Scene scene, const BakeSettings& settings) {
  Progress progress;
  Result<Bake> bake = bake_scene(std::move(scene), settings, progress);
  EXPECT_TRUE(bake) << bake.error().message;
  return {std::move(*bake)};
}
BakeSettings few_rays(int resolution) {
  BakeSettings settings;
  settings.resolution = resolution, settings.samples = 1;
  return settings;
}

/// From a place to a rectangle that stands at right angles to it at a distance c, one of its lower
/// corners straight ahead: width b, height a. [Howell's catalog, B-4]
double corner_factor(double a, double b, double c) {
  const double x = a / b, y = c / b, r = std::hypot(x, y);
  return (std::atan(1 / y) - y / r * std::atan(1 / r)) / (2 * kPiDouble);
}

// The open share is 1 - the form factor of the wall. With 256 rays, spread by the Sobol sequence,
// the error is below 0.01 in nearly all texels. Texels of 9 cm hold means over their area.
TEST(AmbientOcclusion, BesideAWallIsOneLessItsFormFactor) {
  BakeSettings settings = few_rays(64);
  settings.occlusion_distance_m = INFINITY;
  double sum = 0, squares = 0, n = 0;
  for (const auto& [at, value] : maps_of(floor_and_wall(1), settings).on_floor(0)) {
    if (at.x < 0.2f) continue;  // where it varies within a texel
    const double x = double(at.x), z = double(at.z);
    const double open = 1 - corner_factor(1, z, x) - corner_factor(1, 4 - z, x);
    EXPECT_NEAR(value.x, open, 0.03) << x << " " << z;
    sum += double(value.x) - open, squares += std::pow(double(value.x) - open, 2), ++n;
  }
  EXPECT_GT(n, 500);
  EXPECT_LT(std::abs(sum / n), 1e-3);
  EXPECT_LT(std::sqrt(squares / n), 0.008);
}

// Within a distance D only directions count that meet the wall before: of the unit disc that
// directions project to, what lies beyond the chord at d / D [Nusselt].
TEST(AmbientOcclusion, EndsAtItsDistance) {
  BakeSettings settings = few_rays(64);
  settings.occlusion_distance_m = 1;
  double sum = 0, n = 0;
  for (const auto& [at, value] : maps_of(floor_and_wall(3), settings).on_floor(0)) {
    if (at.z < 1 || at.z > 3 || at.x < 0.2f) continue;  // the wall's ends are farther away
    const double s = std::min(double(at.x), 1.0);
    const double met = (std::acos(s) - s * std::sqrt(1 - s * s)) / kPiDouble;
    EXPECT_NEAR(value.x, 1 - met, 0.03) << s;
    sum += double(value.x) - (1 - met), ++n;
  }
  EXPECT_GT(n, 150);
  EXPECT_LT(std::abs(sum / n), 1e-3);
}

// Straight below a sphere of radius r, whose middle is h above: 1 - r^2 / h^2. Facets of 64 x 32
// lie within 0.5 % of the sphere.
TEST(AmbientOcclusion, BelowASphere) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {-0.2f, 0.2f, -0.2f, 0.2f}, 0, true, 0);
  scene::place(scene, scene::sphere("ball", 0.5f, 64, 32, 0), translation({0, 1, 0}));
  BakeSettings settings = few_rays(128);
  settings.occlusion_distance_m = INFINITY;
  double sum = 0, n = 0;
  for (const auto& [at, value] : maps_of(scene, settings).on_floor(0))
    if (std::hypot(at.x, at.z) < 0.05f) sum += double(value.x), ++n;
  ASSERT_GT(n, 3);
  EXPECT_NEAR(sum / n, 0.75, 0.01);
}

// The wall's shadow ends a metre from it; nothing but the shadow is in the mask, also where the
// sun is dim.
TEST(ShadowMask, IsZeroInTheShadowAndOneOutside) {
  scene::Scene scene = floor_and_wall(1);
  add_sun(scene, 0);
  scene.lights[0].intensity = {0, 0, 1e-3f};
  BakeSettings settings = few_rays(64);
  settings.shadow_mask = "auto";
  const Maps maps = maps_of(scene, settings);
  for (const auto& [at, value] : maps.on_floor(0)) {
    if (std::abs(at.x - 1) < 0.15f) continue;
    EXPECT_NEAR(value.x, at.x < 1 ? 0 : 1, 1e-6) << at.x;
    EXPECT_EQ(value.y, 1) << "no light: nothing stands before it";
  }
  const image::Image& page = maps.bake.surface_maps[0].pages.at(0);
  EXPECT_EQ(page.channels, 4);
  EXPECT_EQ(page.at(0, 0)[3], 1);
}

/// The visible part of the sun's disc at x: the wall's edge, 1 m high at x = 0, is a chord of it.
double seen_beside_wall(double x, double radius) {
  const double below = std::atan(1 / x) - kPiDouble / 4;  // the edge above the middle
  const double s = std::clamp(below / radius, -1.0, 1.0);
  return (std::acos(s) - s * std::sqrt(1 - s * s)) / kPiDouble;
}

// The cosine to the disc's parts and the perspective of angles change its share by a few hundredths
// at 0.1 rad. A texel's value is a mean over it, and its sample may lie anywhere in it.
TEST(ShadowMask, HasThePenumbraOfTheSunsDisc) {
  const float radius = 0.1f;
  scene::Scene scene = floor_and_wall(1);
  add_sun(scene, radius);
  BakeSettings settings = few_rays(128);
  settings.shadow_mask = "sun";
  const Maps maps = maps_of(scene, settings);
  const double half_texel = 0.5 / maps.bake.atlas_stats.texels_per_metre;
  double sum = 0, n = 0;
  for (const auto& [at, value] : maps.on_floor(0)) {
    if (at.z < 1 || at.z > 3 || at.x < 2 * half_texel) continue;
    const double x = double(at.x), seen = seen_beside_wall(x, radius);
    EXPECT_GE(value.x, seen_beside_wall(x - half_texel, radius) - 0.05) << x;
    EXPECT_LE(value.x, seen_beside_wall(x + half_texel, radius) + 0.05) << x;
    if (seen > 0 && seen < 1) sum += double(value.x) - seen, ++n;
  }
  EXPECT_GT(n, 100);
  EXPECT_LT(std::abs(sum / n), 0.02);
}

TEST(ShadowMask, TakesLightsByTheirNames) {
  scene::Scene scene = floor_and_wall(1);
  add_sun(scene, 0);
  for (int i = 0; i < 5; ++i) scene.lights.push_back({.name = {}, .position = {2, 1, 2}});
  BakeSettings settings;
  EXPECT_TRUE(masked_lights(settings, scene)->empty());
  settings.shadow_mask = "auto";
  EXPECT_THAT(*masked_lights(settings, scene), testing::ElementsAre(0, 1, 2, 3));
  settings.shadow_mask = "light_4,sun";
  EXPECT_THAT(*masked_lights(settings, scene), testing::ElementsAre(4, 0));
  settings.shadow_mask = "moon";
  const auto unknown = masked_lights(settings, scene);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("sun, light_1"));
  scene.lights.clear();
  const auto none = masked_lights(settings, scene);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("no point, spot or directional light"));
}

}  // namespace
}  // namespace luxel::pipeline
