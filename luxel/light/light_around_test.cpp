#include "luxel/light/light_around.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/procedural.h"

namespace luxel::light {
namespace {

constexpr Rgb gray(float v) { return {v, v, v}; }

/// A plate far away, so that there is something to trace.
scene::Scene almost_empty() {
  scene::Scene scene;
  scene.materials.push_back({});
  scene::Mesh mesh;
  mesh.positions = {{900, 0, 0}, {900, 1, 0}, {900, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.triangle_material = {0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({});
  return scene;
}

scene::PunctualLight sun_from(Vec3 towards) {
  scene::PunctualLight sun;
  sun.kind = scene::PunctualLight::Kind::directional;
  sun.direction = -normalize(towards), sun.intensity = {10, 20, 30};
  return sun;
}

Rgb dark(const scene::SurfacePoint&) { return {}; }

std::vector<Probe> probes(const scene::Scene& scene, const std::vector<Vec3>& at,
                          std::function<Rgb(const scene::SurfacePoint&)> irradiance = dark,
                          AroundParams params = {}) {
  const auto tracer = trace::RayTracer::build(scene);
  const Lights lights = collect_lights(scene);
  Progress progress;
  auto result = light_probes({scene, *tracer, lights, std::move(irradiance)}, at, params, progress);
  EXPECT_TRUE(result);
  return std::move(result->probes);
}

// A sky of radiance L brings pi L to every side.
TEST(LightProbes, UnderASkyOfOneColour) {
  scene::Scene scene = almost_empty();
  scene.background = {1, 2, 3};
  const Probe p = probes(scene, {{0, 0, 0}})[0];
  for (uint32_t k = 0; k < 20; ++k)
    // 512 Sobol points: constants are exact, the other functions' means are a thousandth.
    EXPECT_NEAR(sh2_value(p.irradiance, spiral_direction(k, 20)).y, 2 * kPi, 0.05f);
}

// A lamp, its cosine lobe in two bands: least squares over 48 directions against the integral.
TEST(LightProbes, BesideALamp) {
  scene::Scene scene = almost_empty();
  const Vec3 towards = normalize(Vec3{1, 2, -0.5f});
  scene.lights = {sun_from(towards)};
  const Probe p = probes(scene, {{0, 0, 0}})[0];
  const auto y = sh2_basis(towards);
  for (size_t k = 0; k < kSh2; ++k) {
    const float expected = 10 * y[k] * (k == 0 ? kPi : k < 4 ? 2 * kPi / 3 : kPi / 4);
    // The lobe's higher bands, 0.07 of it, leak in because of the spacing of 48 directions.
    EXPECT_NEAR(p.irradiance[k].x, expected, 0.25f) << k;
    EXPECT_NEAR(p.irradiance[k].z, 3 * p.irradiance[k].x, 1e-4f);
  }
}

// Inside a furnace of radiosity B every direction brings B, half of it emitted, half reflected.
TEST(LightProbes, InsideAFurnace) {
  const scene::Scene scene = scene::furnace_box(gray(0.5f), gray(1));
  const Vec3 middle = scene::world_bounds(scene).centre();
  const auto all_around = [](const scene::SurfacePoint&) { return gray(2 * kPi); };
  const Probe p = probes(scene, {middle}, all_around, {.samples = 4096, .direct_samples = 64})[0];
  // The half that rays bring: nine means over 4,096 points, each good to a thousandth. 64 shadow
  // rays are enough for two to each of the twelve lamps, which makes the other half exact.
  for (uint32_t k = 0; k < 20; ++k)
    EXPECT_NEAR(sh2_value(p.irradiance, spiral_direction(k, 20)).x / (2 * kPi), 1, 0.005f);
  EXPECT_EQ(p.backs, 0);
}

TEST(LightProbes, InsideASolidSeeBacks) {
  // A furnace turned inside out: its walls face away.
  scene::Scene scene = scene::furnace_box(gray(0.5f), gray(0));
  for (scene::Mesh& mesh : scene.meshes) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    mesh.normals.clear();
  }
  const Box3 box = scene::world_bounds(scene);
  const std::vector<Probe> both = probes(scene, {box.centre(), box.upper + Vec3{1, 1, 1}});
  EXPECT_EQ(both[0].backs, 1);
  EXPECT_EQ(both[1].backs, 0);
}

struct BentAt {
  Vec3 normal;
  Rgb flat;
  Bent bent;
  Rgb at(Vec3 m) const {
    const Vec3 d = m - normal;
    return flat + bent.v[0] * d.x + bent.v[1] * d.y + bent.v[2] * d.z;
  }
};

BentAt bent_at(const scene::Scene& scene, Vec3 normal, Rgb flat) {
  const auto tracer = trace::RayTracer::build(scene);
  const Lights lights = collect_lights(scene);
  Progress progress;
  const std::array<Vec3, 1> p{Vec3{}}, n{normal};
  const auto bent =
      bent_irradiance({scene, *tracer, lights, dark}, p, n, n, {.samples = 4096}, progress);
  EXPECT_TRUE(bent);
  return {normal, flat, bent->bent[0]};
}

// One lamp: E(m) = E_s m . s while m faces it.
TEST(BentIrradiance, OfALampIsItsCosine) {
  scene::Scene scene = almost_empty();
  const Vec3 s = normalize(Vec3{0.2f, 1, 0.3f}), n{0, 1, 0};
  scene.lights = {sun_from(s)};
  const BentAt e = bent_at(scene, n, Rgb{10, 20, 30} * dot(n, s));
  RandomStream random{7};
  for (int k = 0; k < 100; ++k) {
    const Vec3 m = normalize(n + Vec3{random.next() - 0.5f, 0, random.next() - 0.5f});
    EXPECT_NEAR(e.at(m).x, 10 * dot(m, s), 2e-4f);
    EXPECT_NEAR(e.at(m).z, 30 * dot(m, s), 6e-4f);
  }
}

// A sky of one colour over the plane: pi L (1 + cos) / 2 for a normal that is tilted.
TEST(BentIrradiance, OfASkyIsItsVisiblePart) {
  scene::Scene scene = almost_empty();
  scene.background = gray(1);
  const Vec3 n = normalize(Vec3{0.3f, 0.5f, -1});
  const BentAt e = bent_at(scene, n, gray(kPi));
  const Frame frame = frame_around(n);
  for (const float tilt : {0.2f, 0.7f, 1.2f}) {
    const Vec3 m = n * std::cos(tilt) + frame.tangent * std::sin(tilt);
    // 4,096 rays; the difference of two sums over the same rays.
    EXPECT_NEAR(e.at(m).x, kPi * (1 + std::cos(tilt)) / 2, 0.01f);
  }
}

}  // namespace
}  // namespace luxel::light
