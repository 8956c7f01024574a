#include "luxel/light/textured_lights.h"

#include <gtest/gtest.h>

#include "luxel/light/direct_light.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/shapes.h"
#include "luxel/viewfactor/rectangle_factor.h"

namespace luxel::light {
namespace {

/// A lamp of 1 x 1 m at height 1 that looks down, around the axis, with u along x and v along z.
/// Its texture is `side` texels square and shines, L = 2, in columns [x0, x1) of rows [y0, y1).
struct Spot {
  int side, x0, x1, y0, y1;
};

scene::Scene lamp_with(const Spot& spot) {
  scene::Scene scene;
  scene::add_material(scene, "lamp", {}, {2, 2, 2});
  scene::Texture texture;
  texture.width = texture.height = spot.side;
  for (int y = 0; y < spot.side; ++y)
    for (int x = 0; x < spot.side; ++x) {
      const bool bright = x >= spot.x0 && x < spot.x1 && y >= spot.y0 && y < spot.y1;
      const uint8_t value = bright ? 255 : 0;
      texture.rgba.insert(texture.rgba.end(), {value, value, value, 255});
    }
  scene.textures.push_back(texture);
  scene.materials[0].emission_texture = {.texture = 0, .filter = scene::Filter::nearest};
  scene::add_rectangle(scene, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, false, 0);
  for (const Vec3& p : scene.meshes[0].positions)
    scene.meshes[0].uv0.push_back({p.x + 0.5f, p.z + 0.5f});
  return scene;
}

/// Light of the same piece of lamp at a point of the floor, in closed form.
double exact_at(const Spot& spot, Vec3 p) {
  const auto edge = [&](int texel, float at) {
    return double(texel) / spot.side - 0.5 - double(at);
  };
  return kPiDouble * 2 *
         viewfactor::rectangle_factor(edge(spot.x0, p.x), edge(spot.x1, p.x), edge(spot.y0, p.z),
                                      edge(spot.y1, p.z), 1);
}

transport::Elements floor_points() {
  transport::Elements e;
  for (int i = 0; i < 25; ++i) {
    const Vec3 place{0.4f * float(i % 5) - 0.7f, 0, 0.4f * float(i / 5) - 0.9f};
    e.normal.push_back({0, 1, 0}), e.position.push_back(scene::off_surface(place, {0, 1, 0}, 1));
  }
  e.geometric_normal = e.normal, e.reflectance.resize(e.size());
  return e;
}

/// Root mean square of relative errors over floor_points(), and that of their mean.
struct DrawErrors {
  double rms = 0, bias = 0;
};
DrawErrors errors_of(const Spot& spot, int samples) {
  const scene::Scene scene = lamp_with(spot);
  const transport::Elements points = floor_points();
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  const auto light =
      direct_light(scene, points, collect_lights(scene), *tracer, {samples, 1}, progress);
  EXPECT_TRUE(light);
  DrawErrors e;
  for (size_t i = 0; i < points.size(); ++i) {
    const double d = double(light->irradiance[i].x) / exact_at(spot, points.position[i]) - 1;
    e.rms += d * d / double(points.size()), e.bias += d / double(points.size());
  }
  e.rms = std::sqrt(e.rms);
  return e;
}

// Pieces whose edges are the row's: each is seen whole: no noise but what choosing some of them
// leaves, whose light differs by their distance. One ray in 16 (in 256) would meet the row without
// pieces: with 64 rays that is an error of half (of twice) the light.
TEST(TexturedLights, ABrightRowBringsWhatItsGeometryWould) {
  for (const Spot& row : {Spot{16, 0, 16, 5, 6}, Spot{64, 0, 64, 41, 42}}) {
    const DrawErrors e = errors_of(row, 64);
    EXPECT_LT(e.rms, 0.02) << row.side;
    EXPECT_LT(std::abs(e.bias), 0.01) << row.side;
  }
}

// Rows thinner than the pieces: a quarter of the rays meets it.
TEST(TexturedLights, ARowThinnerThanThePiecesIsNotBiased) {
  const DrawErrors e = errors_of({256, 0, 256, 77, 78}, 4096);
  EXPECT_LT(e.rms, 0.05);
  EXPECT_LT(std::abs(e.bias), 0.02);
}

TEST(TexturedLights, OneBrightTexelIsFound) {
  const DrawErrors e = errors_of({128, 90, 91, 33, 34}, 64);
  EXPECT_LT(e.rms, 0.02);
}

// Halves of halves tile the triangle: their areas and their light add up, mirrored or not.
TEST(TexturedLights, PiecesAddUpToTheTriangle) {
  const Spot spot{64, 3, 60, 40, 47};
  for (const bool mirrored : {false, true}) {
    scene::Scene scene = lamp_with(spot);
    if (mirrored) scene.instances[0].world_from_object = scaling({-1, 1, 1});
    const Lights lights = collect_lights(scene);
    EXPECT_EQ(lights.emissive_triangles, 2u);
    EXPECT_GT(lights.triangles.size(), 16u);
    double area = 0, flux = 0, measured = 0;
    for (const TriangleLight& l : lights.triangles) {
      const float of_corners = 0.5f * length(cross(l.b - l.a, l.c - l.a));
      EXPECT_NEAR(of_corners, l.area_m2, 1e-6f);
      EXPECT_GT(dot(cross(l.b - l.a, l.c - l.a), l.normal), 0);
      area += double(l.area_m2);
      // The floor of a thousandth for dark pieces adds no more than that.
      flux += double(l.area_m2) * double(l.mean_radiance.x);
      // A point of the piece is looked up where it lies in the world.
      const Vec3 p = (l.a + l.b + l.c) / 3.0f;
      const float x = ((mirrored ? -p.x : p.x) + 0.5f) * float(spot.side);
      const float y = (p.z + 0.5f) * float(spot.side);
      const bool bright =
          x >= float(spot.x0) && x < float(spot.x1) && y >= float(spot.y0) && y < float(spot.y1);
      EXPECT_EQ(radiance_at(scene, l, {1 / 3.f, 1 / 3.f}).x, bright ? 2.0f : 0.0f);
      measured += bright;
    }
    EXPECT_GT(measured, 4);
    EXPECT_NEAR(area, 1, 1e-5);
    EXPECT_NEAR(flux, 2 * 57.0 * 7 / (64 * 64), 0.002 * 2 * 57 * 7 / (64 * 64));
  }
}

}  // namespace
}  // namespace luxel::light
