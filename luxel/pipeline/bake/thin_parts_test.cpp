// Parts thinner than a texel, some of which reach into a wall: each shows light of its own.
#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/texels/resolution.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/drawn_triangle.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/elements.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// A wall on a street under a white sky. Its window sills stick 4 cm into it, and the boxes beside
/// them stand half in it.
scene::Scene facade() {
  scene::Scene scene;
  scene.background = {1, 1, 1};
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::add_rectangle(scene, {0, 12, -1, 5}, 0, true, gray);
  scene::Mesh wall;
  scene::add_box(wall, {0, 0, -0.4f}, {12, 6, 0}, gray);
  scene::place(scene, std::move(wall));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 10; ++column) {
      scene::Mesh sill;
      const float x = 0.5f + 1.1f * float(column) + 0.013f * float(row);
      const float y = 1 + 1.7f * float(row);
      scene::add_box(sill, {x, y, -0.04f}, {x + 0.8f, y + 0.03f, 0.05f}, gray);
      scene::add_box(sill, {x + 0.85f, y, -0.06f}, {x + 0.89f, y + 0.5f, 0.06f}, gray);
      scene::place(scene, std::move(sill));
    }
  return scene;
}

/// Places of a triangle from where rays do not end on backs.
std::vector<scene::SurfacePoint> open_points(const Bake& bake, const trace::RayTracer& tracer,
                                             uint32_t triangle, uint32_t count) {
  const auto drawn = scene::drawn_triangle(bake.atlas.first_triangle, triangle);
  std::vector<scene::SurfacePoint> out;
  for (uint32_t k = 0; k < count; ++k) {
    Vec2 u = sobol_owen_2d(k, triangle);
    if (u.x + u.y > 1) u = {1 - u.x, 1 - u.y};
    const scene::SurfacePoint p{drawn.instance, drawn.triangle, {u.x, u.y}};
    const Vec3 n = scene::front_normal(bake.scene, p.instance, p.triangle);
    const Vec3 from = scene::off_surface(bake.scene, p, n);
    if (transport::all_backs(transport::count_back_faces(bake.scene, tracer, from, n, 32)) == 0)
      out.push_back(p);
  }
  return out;
}

Rgb mean_by_paths(const Bake& bake, const trace::RayTracer& tracer,
                  std::span<const scene::SurfacePoint> points) {
  std::vector<Vec3> position, normal;
  for (const scene::SurfacePoint& p : points) {
    normal.push_back(scene::front_normal(bake.scene, p.instance, p.triangle));
    position.push_back(scene::off_surface(bake.scene, p, normal.back()));
  }
  const std::array<uint32_t, 2> first{0, uint32_t(points.size())};
  Progress progress;
  const auto paths = reference::irradiance_by_paths(bake.scene, {position, normal, normal, first},
                                                    tracer, {.samples = 128}, progress);
  EXPECT_TRUE(paths);
  return paths ? paths->irradiance[0] : Rgb{};
}

/// The atlas is so small that sills are a seventh of a texel high. A white sky of radiance 1 gives
/// pi where nothing is in the way; undersides of sills above a gray street get a third of it.
TEST(ThinParts, ShowLightOfTheirOwn) {
  BakeSettings settings;
  settings.resolution = 80, settings.samples = 256;
  Progress progress;
  const Result<Bake> bake = bake_scene(facade(), settings, progress);
  ASSERT_TRUE(bake) << bake.error().message;
  EXPECT_LT(bake->atlas_stats.texels_per_metre, 8);
  const auto tracer = trace::RayTracer::build(bake->scene);
  ASSERT_TRUE(tracer);
  const transport::TexelField field{&bake->atlas, &bake->map, bake->light.irradiance};
  size_t looked_at = 0, wrong = 0;
  for (uint32_t t = 0; t < bake->atlas.corners.size(); ++t) {
    const auto points = open_points(*bake, *tracer, t, 24);
    if (points.empty()) continue;
    ++looked_at;
    double shown = 0, darkest = 1e9;
    for (const scene::SurfacePoint& p : points) {
      const double e = double(luminance(transport::irradiance_at(field, p)));
      shown += e / double(points.size()), darkest = std::min(darkest, e);
    }
    const double truth = double(luminance(mean_by_paths(*bake, *tracer, points)));
    // No look-up is black: the darkest place, under a sill in the corner, has a twentieth of pi.
    // A texel is wider than a sill is deep, so that a triangle's light may be that of a part of it.
    EXPECT_GT(darkest, 0.05 * kPi) << t;
    wrong += std::abs(shown - truth) > 0.4 * truth + 0.05;
  }
  EXPECT_GT(looked_at, 500u);
  EXPECT_EQ(wrong, 0u) << looked_at;
}

/// The message about the resolution that these settings lead to.
std::string said_of(BakeSettings settings) {
  scene::Scene scene = facade();
  Progress progress;
  const auto settled = settle_resolution(settings, kMostTexelsByDefault, scene, progress);
  const auto layout = lay_out_texels(settled->settings, scene, progress);
  return about_resolution(*settled, layout->atlas, layout->stats);
}

/// A resolution that is too small is said, with one that is not.
TEST(ThinParts, TheResolutionThatWouldDoIsTold) {
  BakeSettings settings;
  settings.resolution = 80, settings.repair_leaks = false;
  const std::string text = said_of(settings);
  const size_t at = text.find("--resolution ");
  ASSERT_NE(at, std::string::npos) << text;
  settings.resolution = std::stoi(text.substr(at + 13));
  EXPECT_EQ(said_of(settings), "") << text;
  // The next smaller one would not do.
  settings.resolution = *settings.resolution / 2;
  EXPECT_NE(said_of(settings), "") << text;
}

}  // namespace
}  // namespace luxel::pipeline
