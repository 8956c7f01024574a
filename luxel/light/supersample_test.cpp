#include "luxel/light/supersample.h"

#include <gtest/gtest.h>

#include <cstring>

#include "luxel/base/parallel.h"
#include "luxel/base/vec2_double.h"

namespace luxel::light {
namespace {

/// A floor on y = 0 from (kRim, kRim) to (16 - kRim, 16 - kRim), one metre to the texel, x to the
/// right and z downwards in the map; its outermost texels are covered in part. A sun of E = 1
/// stands in the zenith and has no disc.
constexpr float kRim = 0.3f;
constexpr int kSupersampleSide = 16;

void add_quad(scene::Scene& scene, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  scene::Mesh mesh;
  mesh.positions = {a, b, c, d};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_material = {0, 0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"", uint32_t(scene.meshes.size() - 1), {}});
}

scene::Scene sunlit_floor() {
  scene::Scene scene;
  scene.materials.emplace_back();
  const float low = kRim, high = kSupersampleSide - kRim;
  add_quad(scene, {low, 0, low}, {low, 0, high}, {high, 0, high}, {high, 0, low});
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = {0, -1, 0};
  sun.intensity = {1, 1, 1};
  scene.lights.push_back(sun);
  return scene;
}

/// The floor's two triangles in the map; whatever else the scene has lies outside of it.
atlas::Atlas atlas_of(const scene::Scene& scene) {
  atlas::Atlas atlas;
  atlas.resolution = kSupersampleSide;
  atlas.first_triangle = scene::first_triangles(scene);
  atlas.corners.resize(atlas.first_triangle.back(), {{{-9, -9}, {-8, -9}, {-9, -8}}});
  atlas.chart.resize(atlas.corners.size(), 1), atlas.chart_count = 2;
  for (size_t t = 0; t < 2; ++t) {
    atlas.chart[t] = 0;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 p = scene.meshes[0].positions[scene.meshes[0].triangles[t][k]];
      atlas.corners[t][k] = {p.x, p.z};
    }
  }
  return atlas;
}

/// Texels of the floor alone: those of other meshes lie nowhere.
atlas::TexelMap map_of(const scene::Scene& scene, const atlas::Atlas& atlas) {
  atlas::Atlas floor = atlas;
  floor.corners.resize(2), floor.first_triangle.resize(2);
  return atlas::rasterise(scene, floor);
}

struct Lit {
  atlas::TexelMap map;
  DirectLight before, after;
  Supersampled done;
};

Lit light(const scene::Scene& scene, int points) {
  const atlas::Atlas atlas = atlas_of(scene);
  Lit out;
  out.map = map_of(scene, atlas);
  const transport::Elements elements = transport::elements_from_texels(scene, atlas, out.map);
  const Lights lights = collect_lights(scene);
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  out.before = *direct_light(scene, elements, lights, *tracer, {}, progress);
  out.after = out.before;
  out.done = *supersample({scene, atlas, out.map, elements, lights, *tracer}, {points, 0.1f, {}},
                          out.after, progress);
  return out;
}

using Polygon = std::vector<DVec2>;

/// The part of a convex polygon with a x + b z <= c [Sutherland and Hodgman].
Polygon clipped(const Polygon& polygon, double a, double b, double c) {
  Polygon out;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const DVec2 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
    const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
    if (at_p <= 0) out.push_back(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0))
      out.push_back(p + (q - p) * (at_p / (at_p - at_q)));
  }
  return out;
}

double area_of(const Polygon& polygon) {
  double twice = 0;
  for (size_t k = 0; k < polygon.size(); ++k)
    twice += cross(polygon[k], polygon[(k + 1) % polygon.size()]);
  return 0.5 * twice;
}

Polygon floor_in(const atlas::Texel& texel) {
  const double low = double(kRim), high = kSupersampleSide - double(kRim);
  const double x0 = std::max(low, double(texel.x)), x1 = std::min(high, double(texel.x) + 1);
  const double y0 = std::max(low, double(texel.y)), y1 = std::min(high, double(texel.y) + 1);
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

// The shade lies over everything with x + 0.3 z > 9.
constexpr double kAcross = 0.3, kEdge = 9;
scene::Scene half_shaded_floor() {
  scene::Scene scene = sunlit_floor();
  const auto x_at = [](float z) { return float(kEdge) - float(kAcross) * z; };
  // Its front looks down: under the back of a sheet points count as inside of a solid.
  add_quad(scene, {x_at(-20), 1, -20}, {60, 1, -20}, {60, 1, 40}, {x_at(40), 1, 40});
  return scene;
}

double lit_share(const atlas::Texel& texel) {
  const Polygon all = floor_in(texel);
  return area_of(clipped(all, 1, kAcross, kEdge)) / area_of(all);
}

struct Errors {
  double rms = 0, largest = 0, edge_texels = 0;
};
/// Over the texels that the edge crosses.
Errors errors_of(const Lit& lit, const std::vector<Rgb>& irradiance) {
  Errors e;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    const double exact = lit_share(lit.map.texels[i]);
    if (exact <= 0 || exact >= 1) continue;
    const double d = std::abs(double(irradiance[i].x) - exact);
    e.rms += d * d, e.largest = std::max(e.largest, d), ++e.edge_texels;
  }
  e.rms = std::sqrt(e.rms / e.edge_texels);
  return e;
}

// A line meets 2 sqrt(N) - 1 of the N cells in which the points lie one each. A cell that it halves
// is off by up to half a point: about sqrt(2 sqrt(N) / 6) / N of the light, root mean square.
TEST(Supersample, TexelsAtAShadowsEdgeGetTheShareOfTheirAreaThatIsLit) {
  const scene::Scene scene = half_shaded_floor();
  for (const int points : {16, 64, 256}) {
    const Lit lit = light(scene, points);
    const Errors before = errors_of(lit, lit.before.irradiance);
    const Errors after = errors_of(lit, lit.after.irradiance);
    ASSERT_GE(after.edge_texels, 16);
    // The texel's own sample is lit or not: on average it is off by a third to a quarter.
    EXPECT_GT(before.rms, 0.2);
    const double expected = std::sqrt(2 * std::sqrt(double(points)) / 6) / points;
    EXPECT_LT(after.rms, 1.2 * expected) << points;
    EXPECT_LT(after.largest, 4 * expected) << points;
  }
}

// The edge x = 15.5 lies between the floor's border, 15.7, and the samples of the last
// texels, 15.35: no sample is in the shade. As above, each texel is off by a few points of 64 at
// most.
TEST(Supersample, AShadowAlongAChartsBorderIsSeenToo) {
  scene::Scene scene = sunlit_floor();
  add_quad(scene, {15.5f, 1, -20}, {60, 1, -20}, {60, 1, 40}, {15.5f, 1, 40});
  const int points = 64;
  const Lit lit = light(scene, points);
  const double tolerance = 4 * std::sqrt(2 * std::sqrt(double(points)) / 6) / points;
  size_t at_border = 0;
  for (size_t i = 0; i < lit.map.texels.size(); ++i) {
    EXPECT_EQ(lit.before.irradiance[i].x, 1.0f);
    const bool border = lit.map.texels[i].x == kSupersampleSide - 1;
    EXPECT_NEAR(lit.after.irradiance[i].x, border ? 5.0 / 7 : 1.0, border ? tolerance : 0) << i;
    at_border += border;
  }
  EXPECT_EQ(at_border, size_t(kSupersampleSide));
}

// All with x > 5 lies in the shade, but for a hole of 0.8 m x 0.4 m above two texels, which the
// samples of both miss, and those of all neighbours. Its share of each is 0.16, to a few points of
// 64 along its rim. The edge of the shade is five texels away.
TEST(Supersample, AFleckThatAllSamplesMissIsFoundFarFromAnyEdge) {
  scene::Scene scene = sunlit_floor();
  const float left = 10.6f, right = 11.4f, near = 8.05f, far = 8.45f;
  add_quad(scene, {5, 1, -20}, {left, 1, -20}, {left, 1, 40}, {5, 1, 40});
  add_quad(scene, {right, 1, -20}, {60, 1, -20}, {60, 1, 40}, {right, 1, 40});
  add_quad(scene, {left, 1, -20}, {right, 1, -20}, {right, 1, near}, {left, 1, near});
  add_quad(scene, {left, 1, far}, {right, 1, far}, {right, 1, 40}, {left, 1, 40});
  const Lit lit = light(scene, 64);
  size_t holes = 0;
  for (size_t i = 0; i < lit.map.texels.size(); ++i) {
    const atlas::Texel& texel = lit.map.texels[i];
    const bool below_hole = texel.y == 8 && (texel.x == 10 || texel.x == 11);
    EXPECT_EQ(lit.before.irradiance[i].x, texel.x < 5 ? 1.0f : 0.0f);
    EXPECT_NEAR(lit.after.irradiance[i].x,
                texel.x < 5  ? 1
                : below_hole ? 0.16
                             : 0,
                below_hole ? 0.06 : 0);
    holes += below_hole;
  }
  EXPECT_EQ(holes, 2u);
}

// A plate of 0.8 m x 0.4 m above the same two texels takes a sixth of their light. The sun has a
// colour, whose light no float adds up exactly.
TEST(Supersample, AFleckOfShadowIsFoundInTheLightOfAColouredSun) {
  scene::Scene scene = sunlit_floor();
  scene.lights[0].intensity = {0.9f, 0.7f, 0.3f};
  const float left = 10.6f, right = 11.4f, near = 8.05f, far = 8.45f;
  add_quad(scene, {left, 1, near}, {right, 1, near}, {right, 1, far}, {left, 1, far});
  const Lit lit = light(scene, 64);
  size_t below_plate = 0;
  for (size_t i = 0; i < lit.map.texels.size(); ++i) {
    const atlas::Texel& texel = lit.map.texels[i];
    const bool below = texel.y == 8 && (texel.x == 10 || texel.x == 11);
    EXPECT_FLOAT_EQ(lit.before.irradiance[i].x, 0.9f) << "no sample lies in the shadow";
    EXPECT_NEAR(lit.after.irradiance[i].x, below ? 0.84 * 0.9 : 0.9, below ? 0.06 : 1e-6);
    below_plate += below;
  }
  EXPECT_EQ(below_plate, 2u);
}

// A sun with a disc and a lamp, with nothing in between. Looking for flecks takes 17 rays of each
// texel, whatever the lamp takes: a ray for each point and the sample. At the border 8 points had 8
// rays each for the disc before.
TEST(Supersample, LookingForFlecksTakesFewRaysBesideALamp) {
  const auto rays = [](bool with_sun) {
    scene::Scene scene = sunlit_floor();
    scene.lights[0].angular_radius_rad = 0.00465f;
    if (!with_sun) scene.lights.clear();
    scene.materials.emplace_back().emission = {9, 9, 9};
    add_quad(scene, {-90, 40, -10}, {-50, 40, -10}, {-50, 40, 30}, {-90, 40, 30});
    scene.meshes.back().triangle_material = {1, 1};
    const Lit lit = light(scene, 16);
    EXPECT_GT(lit.before.irradiance[0].x, with_sun ? 1.0f : 0.01f) << "both shine";
    EXPECT_TRUE(lit.done.texels.empty());
    return double(lit.done.rays);
  };
  constexpr double kAll = kSupersampleSide * kSupersampleSide, kBorder = 4 * (kSupersampleSide - 1);
  EXPECT_EQ(rays(true) - rays(false), 17 * kAll + 8 * 8 * kBorder);
}

// Averaged over texels, the estimated variance is the squared error: here within a factor of three,
// since it takes neighbouring points for the two halves of a stratum.
TEST(Supersample, TheVarianceIsThatOfTheMean) {
  const Lit lit = light(half_shaded_floor(), 64);
  const double rms = errors_of(lit, lit.after.irradiance).rms;
  double variance = 0, count = 0;
  for (size_t i = 0; i < lit.map.texels.size(); ++i) {
    const double exact = lit_share(lit.map.texels[i]);
    if (exact <= 0 || exact >= 1) continue;
    variance += double(lit.after.variance[i]), ++count;
  }
  EXPECT_GT(variance / count, rms * rms / 3);
  EXPECT_LT(variance / count, rms * rms * 3);
}

TEST(Supersample, TexelsWithoutVariationKeepTheirBits) {
  const Lit lit = light(half_shaded_floor(), 16);
  size_t kept = 0;
  for (size_t i = 0; i < lit.map.texels.size(); ++i) {
    const double exact = lit_share(lit.map.texels[i]);
    if (exact > 0 && exact < 1) continue;
    EXPECT_EQ(lit.after.irradiance[i].x, exact) << "texel " << i;
    EXPECT_EQ(std::memcmp(&lit.after.irradiance[i], &lit.before.irradiance[i], sizeof(Rgb)), 0);
    EXPECT_EQ(lit.after.variance[i], lit.before.variance[i]);
    ++kept;
  }
  EXPECT_GT(kept, 200u);
  EXPECT_LT(lit.done.texels.size(), 60u);
  EXPECT_EQ(light(sunlit_floor(), 16).done.texels.size(), 0u);
}

TEST(Supersample, TheSameBitsForAnyNumberOfThreads) {
  const scene::Scene scene = half_shaded_floor();
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return light(scene, 16).after;
  };
  const DirectLight one = with(1), four = with(4);
  ASSERT_EQ(one.irradiance.size(), four.irradiance.size());
  EXPECT_EQ(std::memcmp(one.irradiance.data(), four.irradiance.data(),
                        one.irradiance.size() * sizeof(Rgb)),
            0);
  EXPECT_EQ(one.variance, four.variance);
}

// A block without a bottom stands on the floor from x = z = 5.25 to 9.75: a quarter of each texel
// at its foot is inside of it and dark. Nobody sees that part: what is left is lit by the zenith, E
// = 1.
TEST(Supersample, WhatStandsOnATexelTakesNoLightFromIt) {
  scene::Scene scene = sunlit_floor();
  const float a = 5.25f, b = 9.75f, h = 3;
  add_quad(scene, {a, h, a}, {a, h, b}, {b, h, b}, {b, h, a});
  add_quad(scene, {a, 0, a}, {a, 0, b}, {a, h, b}, {a, h, a});
  add_quad(scene, {b, 0, b}, {b, 0, a}, {b, h, a}, {b, h, b});
  add_quad(scene, {b, 0, a}, {a, 0, a}, {a, h, a}, {b, h, a});
  add_quad(scene, {a, 0, b}, {b, 0, b}, {b, h, b}, {a, h, b});
  const Lit lit = light(scene, 16);
  size_t outside = 0;
  for (size_t i = 0; i < lit.map.texels.size(); ++i) {
    const float x = float(lit.map.texels[i].x) + 0.5f, z = float(lit.map.texels[i].y) + 0.5f;
    const bool inside = x > a && x < b && z > a && z < b;
    EXPECT_NEAR(lit.after.irradiance[i].x, inside ? 0.0f : 1.0f, 1e-5f) << x << ", " << z;
    outside += !inside;
  }
  EXPECT_GT(outside, 200u);
  // 5.25 lies before the centre of its texel, 9.75 behind: the texels there are inside, their
  // neighbours differ from them and were looked at.
  EXPECT_GT(lit.done.texels.size(), 10u);
}

}  // namespace
}  // namespace luxel::light
