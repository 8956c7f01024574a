#include "luxel/solve/gather/gather.h"

#include <gtest/gtest.h>

#include "luxel/base/vec_double.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/shapes.h"
#include "luxel/scene/sides.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/trace/trace_hits.h"
#include "tests/reference_data.h"

namespace luxel::gather {
namespace {

namespace shared = luxel::testing_support;

/// Mean of a channel over the texels of one material, weighted by the surface each texel stands
/// for: all texels have the same density, so partly covered ones count less than they should, which
/// is small at the resolutions used here.
double mean_irradiance(const Room& room, const Gather& result, uint32_t material,
                       float Rgb::*channel) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < result.irradiance.size(); ++i) {
    const auto& p = room.map.texels[i].sample;
    const auto& mesh = room.scene.meshes[room.scene.instances[p.instance].mesh];
    if (mesh.triangle_material[p.triangle] != material) continue;
    sum += double(result.irradiance[i].*channel), ++count;
  }
  return sum / count;
}

// Bounces, layers and errors ask where texels lie in the map, not where they lie in the scene.
TEST(Gather, NeedsNoPlacesOnceAllRaysAreTraced) {
  const auto room = lay_out(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 2, 0.5f}), 32);
  GatherParams params = with_samples(32, 8);
  for (const float max_error : {0.0f, 0.2f}) {
    params.max_error = max_error;
    const Gather kept = solve(*room, params);
    const auto other = lay_out(scene::furnace_box({0.5f, 0.5f, 0.5f}, {1, 2, 0.5f}), 32);
    int calls = 0;
    const auto on_traced = [&] { ++calls, transport::drop_places(other->elements); };
    const Gather dropped = solve(*other, params, {}, nullptr, {.on_traced = on_traced});
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(other->elements.position.capacity(), 0u);
    EXPECT_EQ(other->elements.size(), room->elements.size());
    EXPECT_EQ(dropped.irradiance, kept.irradiance);
    EXPECT_EQ(dropped.errors, kept.errors);
    EXPECT_EQ(dropped.enclosed, kept.enclosed);
  }
}

// Exact solution 1: B = e / (1 - rho) at every point of a closed scene with uniform emission and
// reflectance, so E = (B - e) / rho, or e itself where nothing is reflected.
TEST(SlowGather, AFurnaceIsUniformAtEveryTexel) {
  for (const float rho : {0.0f, 0.5f, 0.9f}) {
    const auto room = lay_out(scene::furnace_box({rho, rho, rho}, {1, 2, 0.5f}), 64);
    const Gather result = solve(*room, with_samples(1024));
    ASSERT_GT(result.irradiance.size(), 1000u);
    const float expected = kPi / (1 - rho);  // pi L / (1 - rho) arrives, for L = 1
    for (size_t i = 0; i < result.irradiance.size(); ++i) {
      ASSERT_NEAR(result.irradiance[i].x / expected, 1.0f, 0.01f)
          << "rho " << rho << " texel " << i;
      ASSERT_NEAR(result.irradiance[i].y / expected, 2.0f, 0.02f)
          << "rho " << rho << " texel " << i;
    }
  }
}

/// A box whose inner sides emit radiosity e, of walls that reflect rho and let tau through, under
/// an even sky: the inside is a furnace, the outside sees nothing but sky.
scene::Scene lampshade(float e, float rho, float tau, float sky) {
  scene::Scene s;
  const uint32_t paper = scene::add_material(s, "paper", {1, 1, 1});
  const float t = 1 - rho;
  s.materials[paper].diffuse_transmission = t;
  s.materials[paper].diffuse_transmission_color = Rgb{1, 1, 1} * (tau / t);
  scene::Mesh box;
  scene::add_box(box, {-1, -1, -1}, {1, 1, 1}, paper);
  const size_t triangles = box.triangles.size();
  scene::place(s, std::move(box));
  scene::add_backs(s, 0, std::vector<uint8_t>(triangles, 1));
  s.materials.push_back(s.materials[paper]);
  s.materials.back().emission = Rgb{1, 1, 1} * (e / kPi);
  for (size_t k = triangles; k < 2 * triangles; ++k) s.meshes[0].triangle_material[k] = 1;
  s.background = Rgb{1, 1, 1} * sky;
  return s;
}

//   E_out = pi sky,  E_in = e + rho E_in + tau E_out
TEST(Gather, EachSideOfALampshadeHasItsOwnLight) {
  const float e = 2, rho = 0.5f, tau = 0.3f, sky = 0.4f;
  const auto room = lay_out(lampshade(e, rho, tau, sky), 96);
  const Gather result = solve(*room, with_samples(256));
  const float out = kPi * sky, in = (e + tau * out) / (1 - rho);
  size_t inside = 0;
  for (size_t i = 0; i < result.irradiance.size(); ++i) {
    const bool is_inside = room->map.texels[i].sample.triangle >= 12;
    inside += is_inside;
    // Every ray meets the same radiosity; direct light, a share of the whole sphere of emitters
    // that shadow rays estimate, and 1e-4 of light to come are what is left.
    ASSERT_NEAR(result.irradiance[i].x, is_inside ? in : out, 0.01f * in) << i;
  }
  EXPECT_NEAR(double(inside) / double(result.irradiance.size()), 0.5, 0.02);
  EXPECT_NEAR(mean_irradiance(*room, result, 1, &Rgb::x), double(in), 1e-3 * double(in));
}

// A plate between two skies: the light of one is not seen on the other side.
TEST(Gather, EachSideOfAPlateSeesItsOwnSky) {
  scene::Scene s;
  scene::add_material(s, "plate", {0.7f, 0.7f, 0.7f});
  s.materials[0].double_sided = true;
  scene::add_rectangle(s, {-1, 1, -1, 1}, 0, true, 0);
  scene::add_backs(s, 0, std::vector<uint8_t>{1, 1});
  s.environment = {8, 4, {}};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      s.environment.radiance.push_back(Rgb{1, 1, 1} * (y < 2 ? 1 : 0.25f));
  const auto room = lay_out(std::move(s), 64);
  const Gather result = solve(*room, with_samples(64));
  for (size_t i = 0; i < result.irradiance.size(); ++i)
    ASSERT_NEAR(result.irradiance[i].x, kPi * (room->map.texels[i].sample.triangle < 2 ? 1 : 0.25f),
                1e-4f);
}

// Exact solution 1, bounce by bounce: B_k = e (1 - rho^(k+1)) / (1 - rho), so E after k reflections
// is B_k of the emitters' light with one reflection less to come: E_k = e sum_{i<=k} rho^i.
TEST(Gather, EveryBounceOfAFurnaceIsCounted) {
  const float rho = 0.5f;
  const auto room = lay_out(scene::furnace_box({rho, rho, rho}, {1, 1, 1}), 32);
  for (const auto& [bounces, factor] : {std::pair{0, 1.0f}, {1, 1.5f}, {2, 1.75f}, {5, 1.96875f}}) {
    GatherParams params = with_samples(256);
    params.bounces = bounces;
    const Gather result = solve(*room, params);
    double mean = 0;
    for (const Rgb& e : result.irradiance) mean += double(e.x) / double(result.irradiance.size());
    // Direct light is exact up to floats; every ray meets the same radiosity.
    EXPECT_NEAR(mean / (double(kPi) * double(factor)), 1.0, 2e-3) << bounces << " bounces";
  }
}

// Exact solution 3: inside a sphere the reflected light arrives uniformly,
// H = mean(e) / (1 - mean(rho)); here one zone by height shines, with an area fraction of its own
// that the facets give. E = mean(e) + mean(rho) H everywhere.
TEST(SlowGather, ASphereSharesItsLightEvenly) {
  scene::Scene scene = scene::inward_sphere(1, 3, {0.5f, 0.5f, 0.5f}, {});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].emission = Rgb{1, 1, 1} / kPi;
  scene.materials[1].base_color = {0.8f, 0.8f, 0.8f};
  scene::Mesh& mesh = scene.meshes[0];
  double area = 0, shining = 0;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const scene::Triangle3 w = scene::world_triangle(scene, 0, t);
    const bool top = w.a.y + w.b.y + w.c.y > 3 * 0.6f;
    if (top) mesh.triangle_material[t] = 1;
    area += double(scene::area_m2(w)), shining += top ? double(scene::area_m2(w)) : 0.0;
  }
  const double f = shining / area, mean_rho = 0.8 * f + 0.5 * (1 - f);
  const double expected =
      f / (1 - mean_rho);  // H of the reference: arriving light, e = 1 on the zone
  const auto room = lay_out(std::move(scene), 128);
  const Gather result = solve(*room, with_samples(256, 256));
  // 1,280 facets are not a sphere: their light arrives uniformly only up to the facets' angle
  // (about 5 degrees), some tenths of a percent.
  EXPECT_NEAR(mean_irradiance(*room, result, 0, &Rgb::x) / expected, 1.0, 0.01);
  EXPECT_NEAR(mean_irradiance(*room, result, 1, &Rgb::x) / expected, 1.0, 0.01);
}

// Exact solution 4: two infinite plates, here a square box a hundred times as wide as high. Its
// sides are black; at the centre they subtend less than 1e-3.
TEST(Gather, ParallelPlatesExchangeLight) {
  scene::Scene scene;
  const auto add_plate = [&](float y, bool up, float rho, float e) {
    scene::Material material;
    material.base_color = {rho, rho, rho};
    material.emission = Rgb{1, 1, 1} * (e / kPi);
    scene.materials.push_back(material);
    scene::Mesh plate;
    plate.positions = {{-50, y, -50}, {-50, y, 50}, {50, y, 50}, {50, y, -50}};
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (!up) plate.triangles = {{0, 2, 1}, {0, 3, 2}};
    plate.triangle_material.assign(2, uint32_t(scene.materials.size() - 1));
    scene.meshes.push_back(plate);
    scene.instances.push_back({"plate", uint32_t(scene.meshes.size() - 1), {}});
  };
  add_plate(0, true, 0.5f, 1);
  add_plate(1, false, 0.8f, 0.25f);
  const auto room = lay_out(std::move(scene), 64);
  const Gather result = solve(*room, with_samples(1024));
  // E1 = B2 and E2 = B1.
  const double b1 = (1 + 0.5 * 0.25) / (1 - 0.4), b2 = (0.25 + 0.8) / (1 - 0.4);
  int checked = 0;
  for (size_t i = 0; i < result.irradiance.size(); ++i) {
    const Vec3 p = room->elements.position[i];
    if (std::abs(p.x) > 10 || std::abs(p.z) > 10) continue;
    // The finite plates miss about (1/40)^2 per bounce at 40 from the edge.
    EXPECT_NEAR(double(result.irradiance[i].x) / (p.y < 0.5f ? b2 : b1), 1.0, 0.005);
    ++checked;
  }
  EXPECT_GT(checked, 20);
}

// Light is linear: with the rays kept, twice the lamp gives twice the light without a new ray.
TEST(Gather, ALightCanChangeWithoutTracingAgain) {
  const auto room = lay_out(scene::cornell_box(), 48);
  Progress progress;
  auto hits = trace_hits(trace_scene(scene_of(*room)), 64, {}, progress);
  ASSERT_TRUE(hits);
  const auto direct = light::direct_light(room->scene, room->elements, room->lights, *room->tracer,
                                          {32, 1}, progress);
  std::vector<Rgb> half = direct->irradiance;
  for (Rgb& e : half) e *= 0.5f;
  const auto full =
      bounce(room->map, room->elements, *hits, direct->irradiance, {}, {-1, 1e-6f}, progress);
  const auto dimmed = bounce(room->map, room->elements, *hits, half, {}, {-1, 1e-6f}, progress);
  for (size_t i = 0; i < half.size(); ++i)
    ASSERT_NEAR(dimmed->irradiance[i].x, 0.5f * full->irradiance[i].x,
                1e-5f * full->irradiance[i].x + 1e-7f);
}

// Inside a closed box every ray of a floor under a solid block meets the block's back: no light,
// and the rays are counted. Blocks of the Cornell box stand on the floor.
TEST(Gather, TexelsInsideSolidsAreDarkAndCounted) {
  const auto room = lay_out(scene::cornell_box(), 128);
  const Gather result = solve(*room, with_samples(64));
  int inside = 0;
  for (size_t i = 0; i < result.irradiance.size(); ++i) {
    const Vec3 p = room->elements.position[i];
    // The middle of the short block's footprint.
    if (p.y > 1e-4f || length(Vec3{p.x - 0.185f, 0, p.z - 0.169f}) > 0.05f) continue;
    EXPECT_EQ(result.irradiance[i], (Rgb{0, 0, 0}));
    EXPECT_EQ(result.met_back[i], 64);
    ++inside;
  }
  EXPECT_GT(inside, 10);
}

/// A closed furnace with a floor of glass half way up: every wall sends B = e / (1 - rho).
scene::Scene divided_furnace(float rho, const scene::Material& pane) {
  scene::Scene scene = scene::furnace_box({rho, rho, rho}, {1, 1, 1});
  const Box3 box = scene::world_bounds(scene);
  const Vec3 a = box.lower, b = box.upper;
  const float y = 0.5f * (a.y + b.y);
  scene.materials.push_back(pane);
  const auto material = uint32_t(scene.materials.size() - 1);
  for (const bool up : {false, true}) {
    scene::Mesh mesh;
    mesh.name = up ? "pane above" : "pane below";
    mesh.positions = {{a.x, y, a.z}, {a.x, y, b.z}, {b.x, y, b.z}, {b.x, y, a.z}};
    if (up)
      mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    else
      mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
    mesh.triangle_material.assign(2, material);
    scene.meshes.push_back(mesh);
    scene.instances.push_back({mesh.name, uint32_t(scene.meshes.size() - 1), {}});
  }
  return scene;
}

// A pane of two faces that reflects and lets through without loss: a furnace stays what it is.
TEST(SlowGather, AFurnaceDoesNotSeeGlassThatLosesNothing) {
  scene::Material pane;
  pane.alpha_mode = scene::AlphaMode::blend;
  pane.base_color = {0.99f, 0.99f, 0.99f};
  pane.alpha = 0.2f;
  const auto room = lay_out(divided_furnace(0.5f, pane), 64);
  // Rays meet the pane by chance: the worst of 3,200 texels is off by five standard deviations.
  const Gather result = solve(*room, with_samples(2048));
  // B = pi / (1 - rho) = 2 pi; E = B everywhere. The pane reflects 0.99 of what it covers and tints
  // by 0.998: 4 in 1,000 of what crosses both faces are lost, a few times over.
  for (const Rgb& e : result.irradiance) EXPECT_NEAR(e.x / (2 * kPi), 1, 0.03);
  double sum = 0;
  for (const Rgb& e : result.irradiance) sum += double(e.x) / (2 * kPiDouble);
  EXPECT_NEAR(sum / double(result.irradiance.size()), 0.995, 0.01);
}

// Whatever lies in files, and however often its pages are let go of.
TEST(Gather, HasTheSameBitsInMappedMemory) {
  constexpr int kSide = 512;  // texels of over a megabyte: less would lie on the heap
  const GatherParams params = with_samples(8, 4);
  const auto memory = std::make_shared<MappedMemory>(::testing::TempDir(), 1);
  const auto mapped = lay_out(scene::cornell_box(), kSide, memory);
  ASSERT_TRUE(memory->holds(mapped->map.texels.data()));
  ASSERT_TRUE(memory->holds(mapped->elements.normal.data()));
  const Gather expected = solve(*lay_out(scene::cornell_box(), kSide), params);
  const Gather found = solve(*mapped, params);
  EXPECT_EQ(found.irradiance, expected.irradiance);
  EXPECT_EQ(found.direct, expected.direct);
  EXPECT_TRUE(memory->trouble());
}

TEST(Gather, KeepsWhatRaysBringInMappedMemory) {
  const auto memory = std::make_shared<MappedMemory>(::testing::TempDir(), UINT64_MAX);
  const TracedHits hits = no_hits(300'000, 0, memory);  // over a megabyte each
  EXPECT_TRUE(memory->holds(hits.sky.data()));
  EXPECT_TRUE(memory->holds(hits.sky_luminance2.data()));
  EXPECT_TRUE(memory->holds(hits.sky_first_less_second.data()));
  EXPECT_EQ(memory->bytes_made(), 300'000 * kBroughtBytesPerElement);
}

}  // namespace
}  // namespace luxel::gather
