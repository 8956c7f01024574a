// Hits: the two sides of a surface, shading normals, alpha, and the view of a camera.
#include "luxel/reference/surfaces.h"

#include <gtest/gtest.h>

#include "luxel/reference/reference_test_support.h"
#include "luxel/scene/off_surface.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/sides.h"

namespace luxel::reference {
namespace {

using namespace testing;

scene::PunctualLight sun(Vec3 direction) {
  scene::PunctualLight light;
  light.kind = scene::PunctualLight::Kind::directional;
  light.direction = direction;
  return light;
}

// A thin white sheet lit from above: its underside is dark when it is double-sided, and black when
// it is not. The light of the front does not come through.
TEST(SurfacesOfPaths, EachSideOfASheetHasItsOwnLight) {
  scene::Scene scene;
  scene::add_material(scene, "sheet", gray(0.8f));
  scene::add_rectangle(scene, {-100, 100, -100, 100}, 1, true, 0);
  scene.lights.push_back(sun({0, -1, 0}));
  Points points;
  points.add({0, 0, 0}, {0, 1, 0});   // under the sheet, looking up at its back
  points.add({0, 2, 0}, {0, -1, 0});  // above it, looking down
  for (const bool double_sided : {false, true}) {
    scene.materials[0].double_sided = double_sided;
    const TexelPaths below = solve(scene, points, {.samples = 400});
    EXPECT_EQ(below.irradiance[0], (Rgb{}));
    EXPECT_NEAR(below.irradiance[1].x, 0.8, 1e-3);  // rho E, all around
    EXPECT_EQ(below.met_back[0], double_sided ? 0u : 400u);
    EXPECT_EQ(below.met_double_sided_back[0], double_sided ? 400u : 0u);
    EXPECT_EQ(below.enclosed[0], 1);
    EXPECT_EQ(below.enclosed[1], 0);
    // Lit from below, only the back of the double-sided sheet reflects.
    scene.lights[0].direction = {0, 1, 0};
    const TexelPaths from_below = solve(scene, points, {.samples = 400});
    EXPECT_NEAR(from_below.irradiance[0].x, double_sided ? 0.8 : 0.0, 1e-3);
    EXPECT_EQ(from_below.irradiance[1], (Rgb{}));
    scene.lights[0].direction = {0, -1, 0};
  }
}

// A closed box of double-sided walls whose fronts look outwards is a furnace inside: the backs
// shine and reflect as the fronts do.
TEST(SurfacesOfPaths, TheInsideOfADoubleSidedBoxIsAFurnace) {
  scene::Scene scene;
  scene::add_material(scene, "box", gray(0.5f), gray(1));
  scene.materials[0].double_sided = true;
  scene::Mesh box;
  scene::add_box(box, {-1, -1, -1}, {1, 1, 1}, 0);
  scene::place(scene, std::move(box));
  Points points = random_points(scene, 100, 1);
  for (size_t k = 0; k < points.size(); ++k) {  // to the other side
    points.normal[k] = -points.normal[k];
    points.position[k] += 2 * points.normal[k] * scene::rounding_m(points.position[k], 1);
  }
  expect_unbiased(solve(scene, points, {.samples = 500}), std::vector<double>(100, 2 * kPiDouble));
}

// A black sheet under a sky of 1, whose corners alone say how much of it is there. A ramp from 0 to
// 1 cut at 0.5 leaves the half [0, 1]; half of it blended stops half of the light, and darkens the
// rest by half.
TEST(SurfacesOfPaths, VertexAlphaCutsAndBlends) {
  scene::Scene scene;
  scene::add_material(scene, "sheet", {});
  scene.materials[0].double_sided = true;
  scene::add_rectangle(scene, {-1, 1, -1, 1}, 1, true, 0);
  scene.background = gray(1);
  Points points;
  points.add({0.2f, 0, 0.1f}, {0, 1, 0});
  const double whole = rectangle_factor(-1.2, 0.8, -1.1, 0.9, 1),
               half = rectangle_factor(-0.2, 0.8, -1.1, 0.9, 1);
  const auto expect = [&](scene::AlphaMode mode, auto alpha_at, double hidden) {
    scene.materials[0].alpha_mode = mode;
    scene.meshes[0].alphas.clear();
    for (const Vec3& p : scene.meshes[0].positions) scene.meshes[0].alphas.push_back(alpha_at(p));
    expect_unbiased(solve(scene, points, {.samples = 20000}), {kPiDouble * (1 - hidden)});
  };
  for (const scene::AlphaMode mode : {scene::AlphaMode::mask, scene::AlphaMode::blend})
    expect(
        mode, [](Vec3) { return 0.0f; }, 0);
  expect(
      scene::AlphaMode::mask, [](Vec3 p) { return 0.5f + 0.5f * p.x; }, half);
  expect(
      scene::AlphaMode::blend, [](Vec3) { return 0.5f; }, 0.75 * whole);
  expect(
      scene::AlphaMode::opaque, [](Vec3) { return 0.0f; }, whole);
}

/// A box of uniform light inside: every inner side emits radiosity e. Its walls reflect rho and let
/// tau through; outside is a sky of radiance `sky`. The inside is a furnace, whatever its shape,
/// and the outside sees nothing but sky:
///   E_out = pi sky,  E_in = e + rho E_in + tau E_out,  B_out = rho E_out + tau E_in.
struct Lampshade {
  scene::Scene scene;
  double in = 0, out = 0, sent = 0;  ///< E_in, E_out, B_out
};
Lampshade lampshade(bool linked) {
  const float t = 0.4f, c = 0.5f, albedo = 0.8f, e = 2, sky = 0.3f;
  Lampshade out;
  scene::Scene& s = out.scene;
  const uint32_t paper = scene::add_material(s, "paper", gray(albedo));
  s.materials[paper].diffuse_transmission = t;
  s.materials[paper].diffuse_transmission_color = gray(c);
  scene::Mesh box;
  scene::add_box(box, {-1, -1, -1}, {1, 1, 1}, paper);
  const size_t triangles = box.triangles.size();
  scene::place(s, std::move(box));
  s.background = gray(sky);
  const double rho = double(albedo * (1 - t)), tau = double(t * c);
  out.out = kPiDouble * double(sky);
  double inside = 0;
  if (linked) {
    scene::add_backs(s, 0, std::vector<uint8_t>(triangles, 1));
    s.materials.push_back(s.materials[paper]);
    s.materials.back().emission = gray(e / kPi);
    for (size_t k = triangles; k < 2 * triangles; ++k) s.meshes[0].triangle_material[k] = 1;
    inside = double(e);
  }
  out.in = (inside + tau * out.out) / (1 - rho);
  out.sent = rho * out.out + tau * out.in;
  return out;
}

// Also where the two sides are not told apart: a box as it comes from a file, which emits nothing.
TEST(SurfacesOfPaths, LightIsScatteredThroughALampshade) {
  for (const bool linked : {true, false}) {
    const Lampshade shade = lampshade(linked);
    Points inside, outside, beside;
    for (int k = 0; k < 20; ++k) {
      const float x = -0.9f + 0.09f * float(k), y = 0.05f * float(k) - 0.7f;
      inside.add({x, y, 1}, {0, 0, -1});
      outside.add({x, y, 1}, {0, 0, 1});
      beside.add({x, y, 2}, {0, 0, -1});
    }
    expect_unbiased(solve(shade.scene, inside, {.samples = 2000}),
                    std::vector<double>(inside.size(), shade.in));
    expect_unbiased(solve(shade.scene, outside, {.samples = 100}),
                    std::vector<double>(outside.size(), shade.out));
    std::vector<double> exact;
    for (size_t k = 0; k < beside.size(); ++k) {
      const double f = polygon_factor(beside.position[k], beside.normal[k],
                                      {{1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}});
      exact.push_back(f * shade.sent + (1 - f) * shade.out);
    }
    expect_unbiased(solve(shade.scene, beside, {.samples = 2000}), exact);
  }
}

TexelPaths at_bent_point(const scene::Scene& scene, Vec3 p, Vec3 n, int samples) {
  const auto tracer = trace::RayTracer::build(scene);
  const Vec3 up{0, 1, 0}, start = scene::off_surface(p, up, 1);
  Progress progress;
  auto result = irradiance_by_paths(scene, {{&start, 1}, {&n, 1}, {&up, 1}}, *tracer,
                                    {.samples = samples}, progress);
  EXPECT_TRUE(result);
  return std::move(*result);
}

// A shading normal at the angle d from the triangle's own, in a furnace of exitance e: reflected
// light is folded, so that none is lost; of the emitted light what comes from below the triangle is
// missing, (1 - cos d) / 2.  E = e (1 + cos d) / 2 + e rho / (1 - rho).
TEST(SurfacesOfPaths, BentNormalsKeepReflectedLight) {
  const scene::Scene scene = scene::furnace_box(gray(0.6f), gray(1));
  const Vec3 centre = scene::world_bounds(scene).centre();
  const Vec3 floor{centre.x, scene::world_bounds(scene).lower.y, centre.z};
  for (const float angle : {0.0f, 0.2f, 0.8f, 1.3f}) {
    const Vec3 n{std::sin(angle), std::cos(angle), 0};
    const TexelPaths e = at_bent_point(scene, floor, n, 40000);
    const double exact = kPiDouble * ((1 + std::cos(double(angle))) / 2 + 0.6 / 0.4);
    EXPECT_NEAR(double(e.irradiance[0].x), exact, 3 * double(e.standard_error[0].x)) << angle;
    EXPECT_LT(e.standard_error[0].x, 0.01 * exact);
  }
}

TEST(SurfacesOfPaths, BentNormalsKeepTheLightOfTheSky) {
  scene::Scene scene;
  scene.background = gray(1);
  scene::add_material(scene, "far", {});
  scene::add_rectangle(scene, {100, 101, 100, 101}, -100, true, 0);
  EXPECT_NEAR(at_bent_point(scene, {}, normalize(Vec3{1, 1, 0.3f}), 100).irradiance[0].x, kPiDouble,
              1e-5);
}

// Lamps and emitters are seen with the plain cosine about the shading normal, and not from below
// the triangle's own plane.
TEST(SurfacesOfPaths, BentNormalsSeeLampsWithTheirCosineAboveTheTriangle) {
  const Vec3 n = normalize(Vec3{1, 1, 0});
  for (const Vec3 to_light : {Vec3{0.2f, 1, 0}, {1, 0.1f, 0}, {1, -0.1f, 0}, {-1, 0.9f, 0}}) {
    const Vec3 towards = normalize(to_light);
    const double cosine = towards.y > 0 ? std::max(0.0, double(dot(towards, n))) : 0;
    scene::Scene lit;
    scene::add_material(lit, "lamp", {}, gray(1));
    // A small square emitter at distance 10, of 1e-4 sr.
    const Frame f = frame_around(-towards);
    const Vec3 c = towards * 10, x = f.tangent * 0.05f, y = f.bitangent * 0.05f;
    scene::Mesh mesh;
    scene::add_quad(mesh, {c - x - y, c + x - y, c + x + y, c - x + y}, 0);
    scene::place(lit, std::move(mesh));
    EXPECT_NEAR(double(at_bent_point(lit, {}, n, 4000).irradiance[0].x), cosine * 1e-4,
                2e-3 * cosine * 1e-4);
    scene::Scene sunny;
    sunny.lights.push_back(sun(-towards));
    EXPECT_NEAR(double(at_bent_point(sunny, {}, n, 4).irradiance[0].x), cosine, 1e-5);
  }
}

Picture picture_of(const scene::Scene& scene, const scene::Camera& camera,
                   const PathParams& params) {
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  auto picture = radiance_by_paths(scene, *tracer, camera, 24, 16, params, progress);
  EXPECT_TRUE(picture);
  return std::move(*picture);
}

// Inside a furnace every pixel has L / (1 - rho).
TEST(PathPictures, AFurnaceIsUniform) {
  const scene::Scene scene = scene::furnace_box(gray(0.5f), {1, 2, 3});
  scene::Camera camera;
  camera.world_from_camera = translation(scene::world_bounds(scene).centre());
  const Picture picture = picture_of(scene, camera, {.samples = 400});
  double sum = 0, variance = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) {
      const double error = double(picture.luminance_error[size_t(y * 24 + x)]);
      const double exact = 2 * double(luminance({1, 2, 3}));
      EXPECT_NEAR(double(luminance(picture.radiance.rgb(x, y))), exact, 5 * error);
      EXPECT_EQ(picture.radiance.at(x, y)[3], 1);
      sum += double(luminance(picture.radiance.rgb(x, y))) - exact, variance += error * error;
    }
  EXPECT_LT(std::abs(sum), 3 * std::sqrt(variance));
  EXPECT_GT(variance, 0);
}

// A sheet under a sun against a background: rho E / pi, the background, and their mean on the edge,
// where pixels show part of the sheet.
TEST(PathPictures, PixelsAreMeansOfTheirSquares) {
  scene::Scene scene;
  scene.background = gray(0.25f);
  scene::Mesh sheet;
  // At distance 1 the picture reaches from -1.5 to 1.5: a pixel is 1/8 wide, and the sheet's edge
  // lies a quarter into column 13.
  const float edge = 0.125f + 0.03125f, far = 20;
  scene::add_quad(sheet, {Vec3{-far, -far, -1}, {edge, -far, -1}, {edge, far, -1}, {-far, far, -1}},
                  0);
  scene::add_material(scene, "sheet", gray(0.5f), gray(0.1f));
  scene::place(scene, std::move(sheet));
  scene::PunctualLight light = sun({0, 0, -1});
  light.intensity = gray(2);
  scene.lights.push_back(light);
  scene::Camera camera;
  camera.fov_y_rad = 2 * std::atan(1.0f);
  const Picture picture = picture_of(scene, camera, {.samples = 10000});
  // The sky adds pi * 0.25 to E.
  const double lit = 0.1 + 0.5 * (2 + 0.25 * kPiDouble) / kPiDouble;
  EXPECT_NEAR(double(picture.radiance.rgb(3, 8).x), lit, 1e-4);
  EXPECT_EQ(picture.radiance.rgb(20, 8).x, 0.25f);
  EXPECT_EQ(picture.radiance.at(20, 8)[3], 0);
  EXPECT_NEAR(double(picture.radiance.at(13, 8)[3]), 0.25, 0.02);
  EXPECT_NEAR(double(picture.radiance.rgb(13, 8).x), 0.25 * lit + 0.75 * 0.25, 0.01);
}

// The camera looks through the backs of one-sided surfaces, into a closed room from outside.
TEST(PathPictures, TheCameraLooksThroughBacks) {
  const scene::Scene scene = scene::furnace_box(gray(0.5f), gray(1));
  const Vec3 outside = scene::world_bounds(scene).centre() + Vec3{0, 0, 3};
  scene::Camera camera;
  camera.world_from_camera = translation(outside);
  const Picture picture = picture_of(scene, camera, {.samples = 200});
  EXPECT_NEAR(picture.radiance.rgb(12, 8).x, 2, 5 * picture.luminance_error[8 * 24 + 12]);
}

}  // namespace
}  // namespace luxel::reference
