#include "luxel/pipeline/reuse/kept_bake.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>

#include "luxel/base/random.h"
#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

using Bytes = std::vector<std::byte>;

scene::Mesh some_mesh() {
  scene::Mesh mesh;
  mesh.name = "mesh";
  scene::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1);
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.uv0 = {{0, 0}, {1, 0}, {0, 1}}, mesh.uv1 = {{0, 0}, {2, 0}, {0, 2}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.other_side = {scene::kNone};
  return mesh;
}

/// Two texels, two instances, two lamps and two layers; every member has a value of its own.
KeptBake some_bake() {
  KeptBake k;
  k.scene.meshes = {11, 12}, k.scene.mesh_names = {"first", ""};
  k.scene.instances = {{"a", 0, translation({1, 2, 3}), {{0, 0, 0}, {1, 1, 1}}},
                       {"b", 1, translation({4, 5, 6}), {}}};
  k.scene.materials = {{"m", 21, 22, 23, {1, 2, 3}}, {"n", 24, 25, 26, {4, 5, 6}}};
  k.scene.lights = {{"l", 31, {7, 8, 9}}, {"off", 32, {}}};
  k.scene.surroundings = 41, k.scene.mesh_materials = {{0}, {0, 1}};
  k.seconds = 12.5;
  k.layout.meshes = {some_mesh(), some_mesh()}, k.layout.mesh_of_instance = {0, 1};
  atlas::Atlas& atlas = k.layout.atlas;
  atlas.resolution = 16, atlas.first_triangle = {0, 1, 2};
  atlas.corners = {{Vec2{0, 0}, {4, 0}, {0, 4}}, {Vec2{8, 8}, {12, 8}, {8, 12}}};
  atlas.chart = {0, 1}, atlas.chart_count = 2, atlas.kept = true;
  atlas.pages = {{0, 0, 8}, {8, 8, 8}}, atlas.page = {0, 1};
  k.layout.texels = {{1, 2, {0, 0, {0.25f, 0.5f}}, 0, true},
                     {9, 10, {1, 0, {0.1f, 0.2f}}, 1, false}};
  k.layout.stats = {1, 0.25, 1.5, 100, 2, 0.75};
  k.layout.repair = {1, 2, {0}, {1}, {0, 1}}, k.layout.near_back_faces = {1},
  k.layout.warnings = {"careful", "very"};
  k.places = {51, 52}, k.layer_names = {"l", "b"};
  k.layers = {{0, LayersOfLights::kNoLayer}, {{}, {0, 1}}, 1};
  k.direct.irradiance = {{1, 1, 1}, {2, 2, 2}}, k.direct.variance = {0.1f, 0.2f};
  k.direct.split_variance = {0.3f, 0.4f}, k.direct.rays = 61;
  k.direct.by_layer = {{1, 0, 0}, {0, 1, 1}, {2, 0, 0}, {0, 2, 2}};
  k.levels = {{1, 2}, {0, 1}};
  TexelLight& l = k.light;
  l.irradiance = {{3, 3, 3}, {4, 4, 4}}, l.variance = {0.5f, 0.6f};
  l.direct = {{5, 5, 5}, {6, 6, 6}}, l.direct_variance = {0.7f, 0.8f};
  l.errors = {0.01f, 0.02f}, l.error_p95 = 0.03f;
  l.layers = {{"l", {"l"}}, {"b", {"b", "b too"}}};
  l.layer_irradiance = {{{3, 0, 0}, {4, 0, 0}}, {{0, 3, 3}, {0, 4, 4}}};
  l.samples = {32, 64}, l.rays = 71, l.supersampled_texels = 72, l.sweeps = 73;
  l.relative_error = 0.04, l.hidden = {0, 1}, l.suspicious_texels = 74;
  return k;
}

void expect_same(const scene::SceneState& a, const scene::SceneState& b) {
  EXPECT_EQ(a.meshes, b.meshes);
  EXPECT_EQ(a.mesh_names, b.mesh_names);
  EXPECT_EQ(a.surroundings, b.surroundings);
  EXPECT_EQ(a.mesh_materials, b.mesh_materials);
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].name, b.instances[i].name);
    EXPECT_EQ(a.instances[i].mesh, b.instances[i].mesh);
    EXPECT_EQ(a.instances[i].world_from_object, b.instances[i].world_from_object);
    EXPECT_EQ(a.instances[i].bounds.lower, b.instances[i].bounds.lower);
    EXPECT_EQ(a.instances[i].bounds.upper, b.instances[i].bounds.upper);
    EXPECT_EQ(a.instances[i].density, b.instances[i].density);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_EQ(a.materials[i].name, b.materials[i].name);
    EXPECT_EQ(a.materials[i].shape, b.materials[i].shape);
    EXPECT_EQ(a.materials[i].colour, b.materials[i].colour);
    EXPECT_EQ(a.materials[i].emission_shape, b.materials[i].emission_shape);
    EXPECT_EQ(a.materials[i].emission, b.materials[i].emission);
  }
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].name, b.lights[i].name);
    EXPECT_EQ(a.lights[i].shape, b.lights[i].shape);
    EXPECT_EQ(a.lights[i].intensity, b.lights[i].intensity);
  }
}

void expect_same(const scene::Mesh& a, const scene::Mesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.uv0, b.uv0);
  EXPECT_EQ(a.uv1, b.uv1);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.triangle_material, b.triangle_material);
  EXPECT_EQ(a.other_side, b.other_side);
}

void expect_same(const atlas::Atlas& a, const atlas::Atlas& b) {
  EXPECT_EQ(a.resolution, b.resolution);
  EXPECT_EQ(a.first_triangle, b.first_triangle);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.chart, b.chart);
  EXPECT_EQ(a.chart_count, b.chart_count);
  EXPECT_EQ(a.kept, b.kept);
  EXPECT_EQ(a.page, b.page);
  ASSERT_EQ(a.pages.size(), b.pages.size());
  for (size_t i = 0; i < a.pages.size(); ++i) {
    EXPECT_EQ(a.pages[i].x, b.pages[i].x);
    EXPECT_EQ(a.pages[i].y, b.pages[i].y);
    EXPECT_EQ(a.pages[i].side, b.pages[i].side);
  }
}

void expect_same(const KeptLayout& a, const KeptLayout& b) {
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (size_t i = 0; i < a.meshes.size(); ++i) expect_same(a.meshes[i], b.meshes[i]);
  EXPECT_EQ(a.mesh_of_instance, b.mesh_of_instance);
  expect_same(a.atlas, b.atlas);
  ASSERT_EQ(a.texels.size(), b.texels.size());
  for (size_t i = 0; i < a.texels.size(); ++i) {
    const atlas::Texel &s = a.texels[i], &t = b.texels[i];
    EXPECT_EQ(s.x, t.x);
    EXPECT_EQ(s.y, t.y);
    EXPECT_EQ(s.sample.instance, t.sample.instance);
    EXPECT_EQ(s.sample.triangle, t.sample.triangle);
    EXPECT_EQ(s.sample.at.u, t.sample.at.u);
    EXPECT_EQ(s.sample.at.v, t.sample.at.v);
    EXPECT_EQ(s.triangle_number, t.triangle_number);
    EXPECT_EQ(s.centre_covered, t.centre_covered);
  }
  EXPECT_EQ(a.stats.charts, b.stats.charts);
  EXPECT_EQ(a.stats.utilisation, b.stats.utilisation);
  EXPECT_EQ(a.stats.mean_stretch_l2, b.stats.mean_stretch_l2);
  EXPECT_EQ(a.stats.texels_per_metre, b.stats.texels_per_metre);
  EXPECT_EQ(a.stats.triangles_without_texel, b.stats.triangles_without_texel);
  EXPECT_EQ(a.stats.owning_triangles, b.stats.owning_triangles);
  EXPECT_EQ(a.repair.cuts, b.repair.cuts);
  EXPECT_EQ(a.repair.parted, b.repair.parted);
  EXPECT_EQ(a.repair.overlapping, b.repair.overlapping);
  EXPECT_EQ(a.repair.moved, b.repair.moved);
  EXPECT_EQ(a.repair.refilled, b.repair.refilled);
  EXPECT_EQ(a.near_back_faces, b.near_back_faces);
  EXPECT_EQ(a.warnings, b.warnings);
}

void expect_same(const TexelLight& a, const TexelLight& b) {
  EXPECT_EQ(a.irradiance, b.irradiance);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.direct_variance, b.direct_variance);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_EQ(a.error_p95, b.error_p95);
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (size_t i = 0; i < a.layers.size(); ++i) {
    EXPECT_EQ(a.layers[i].name, b.layers[i].name);
    EXPECT_EQ(a.layers[i].lights, b.layers[i].lights);
  }
  EXPECT_EQ(a.layer_irradiance, b.layer_irradiance);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.supersampled_texels, b.supersampled_texels);
  EXPECT_EQ(a.sweeps, b.sweeps);
  EXPECT_EQ(a.relative_error, b.relative_error);
  EXPECT_EQ(a.hidden, b.hidden);
  EXPECT_EQ(a.suspicious_texels, b.suspicious_texels);
}

void expect_same(const KeptBake& a, const KeptBake& b) {
  expect_same(a.scene, b.scene);
  EXPECT_EQ(a.seconds, b.seconds);
  expect_same(a.layout, b.layout);
  EXPECT_EQ(a.places, b.places);
  EXPECT_EQ(a.layer_names, b.layer_names);
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.direct.irradiance, b.direct.irradiance);
  EXPECT_EQ(a.direct.variance, b.direct.variance);
  EXPECT_EQ(a.direct.split_variance, b.direct.split_variance);
  EXPECT_EQ(a.direct.by_layer, b.direct.by_layer);
  EXPECT_EQ(a.direct.rays, b.direct.rays);
  EXPECT_EQ(a.levels.level, b.levels.level);
  EXPECT_EQ(a.levels.averaged, b.levels.averaged);
  expect_same(a.light, b.light);
}

/// Its parts, each with its size before it.
Bytes bytes_of(const KeptBake& kept) {
  Bytes out;
  for (size_t part = 0; part < kKeptParts; ++part) {
    const Bytes bytes = pipeline::bytes_of(kept, part);
    const uint64_t size = bytes.size();
    const auto size_bytes = std::as_bytes(std::span(&size, 1));
    out.insert(out.end(), size_bytes.begin(), size_bytes.end());
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
  return out;
}

std::optional<KeptBake> kept_bake_of(std::span<const std::byte> bytes) {
  KeptBake out;
  for (size_t part = 0; part < kKeptParts; ++part) {
    uint64_t size = 0;
    if (bytes.size() < sizeof(size)) return std::nullopt;
    std::memcpy(&size, bytes.data(), sizeof(size));
    bytes = bytes.subspan(sizeof(size));
    if (bytes.size() < size || !read_part(bytes.first(size), part, out)) return std::nullopt;
    bytes = bytes.subspan(size);
  }
  return bytes.empty() && is_whole(out) ? std::optional(out) : std::nullopt;
}

bool is_refused(const std::function<void(KeptBake&)>& edit) {
  KeptBake kept = some_bake();
  edit(kept);
  return !kept_bake_of(bytes_of(kept));
}

TEST(KeptBake, ComesBackFromItsBytes) {
  const KeptBake kept = some_bake();
  const Bytes bytes = bytes_of(kept);
  const auto found = kept_bake_of(bytes);
  ASSERT_TRUE(found);
  expect_same(*found, kept);
  EXPECT_EQ(bytes_of(*found), bytes);
}

TEST(KeptBake, WithoutLayersComesBack) {
  KeptBake kept = some_bake();
  kept.layer_names = {}, kept.layers = {}, kept.direct.by_layer = {};
  kept.light.layers = {}, kept.light.layer_irradiance = {};
  const auto found = kept_bake_of(bytes_of(kept));
  ASSERT_TRUE(found);
  expect_same(*found, kept);
  EXPECT_TRUE(kept_bake_of(bytes_of(KeptBake{}))) << "of nothing";
}

TEST(KeptBake, CutOffAnywhereIsRefused) {
  const Bytes bytes = bytes_of(some_bake());
  EXPECT_LT(bytes.size(), 5000u) << "all lengths are tried";
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(kept_bake_of(std::span(bytes).first(size))) << size;
  Bytes longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(kept_bake_of(longer));
}

// Numbers of things that follow become huge: nobody asks for memory that the file cannot fill. What
// is taken for a bake nevertheless can be written again.
TEST(KeptBake, DamagedAnywhereIsRefusedOrWhole) {
  const Bytes bytes = bytes_of(some_bake());
  size_t refused = 0, taken = 0;
  const auto look_at = [&](const Bytes& damaged) {
    const auto found = kept_bake_of(damaged);
    ++(found ? taken : refused);
    if (found) {
      EXPECT_TRUE(bytes_of(*found) == damaged);
    }
  };
  for (size_t at = 0; at < bytes.size(); ++at)
    for (const int flip : {0x01, 0x80, 0xff}) {
      Bytes damaged = bytes;
      damaged[at] ^= std::byte(flip);
      look_at(damaged);
    }
  for (size_t at = 0; at + 8 <= bytes.size(); ++at)
    for (const uint64_t number : {UINT64_MAX, uint64_t(1) << 61, uint64_t(1) << 40}) {
      Bytes damaged = bytes;
      std::memcpy(damaged.data() + at, &number, sizeof(number));
      look_at(damaged);
    }
  RandomStream random{5};
  for (int k = 0; k < 5000; ++k) {
    Bytes damaged = bytes;
    for (int n = 1 + int(4 * random.next()); n > 0; --n)
      damaged[size_t(random.next() * float(bytes.size()))] = std::byte(int(256 * random.next()));
    look_at(damaged);
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(taken, 1000u) << "numbers may be others";
}

// A yes or no of any other byte is neither.
TEST(KeptBake, KnowsYesFromNo) {
  KeptBake kept = some_bake();
  const Bytes yes = bytes_of(kept);
  kept.layout.atlas.kept = false;
  Bytes no = bytes_of(kept);
  const auto at = std::ranges::mismatch(yes, no).in2;
  ASSERT_NE(at, no.end());
  ASSERT_TRUE(kept_bake_of(no));
  *at = std::byte{2};
  EXPECT_FALSE(kept_bake_of(no));
}

TEST(KeptBake, WithNumbersThatDoNotFitIsRefused) {
  EXPECT_FALSE(is_refused([](KeptBake&) {}));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.places.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.texels.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.direct.irradiance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.direct.variance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.direct.split_variance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.direct.by_layer.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.levels.level.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.levels.averaged.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.irradiance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.variance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.direct.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.direct_variance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.hidden.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.layers.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.layer_irradiance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.light.layer_irradiance[1].pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layer_names.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layers.of_punctual.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layers.of_instance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.mesh_of_instance.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.scene.instances.pop_back(); }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.scene.lights.pop_back(); }));
}

TEST(KeptBake, ThatRefersToWhatIsNotThereIsRefused) {
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layers.of_punctual[0] = 2; }));
  EXPECT_TRUE(
      is_refused([](KeptBake& k) { k.layers.of_instance[1][0] = LayersOfLights::kNoLayer; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layers.of_surroundings = 2; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.mesh_of_instance[0] = 2; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.texels[0].x = 16; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.texels[1].y = UINT16_MAX; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.texels[1].sample.instance = 2; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.texels[1].triangle_number = 2; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.atlas.resolution = -1; }));
  EXPECT_TRUE(is_refused([](KeptBake& k) { k.layout.near_back_faces = {2}; }));
}

/// Made in memory full of a byte.
Bytes bytes_over(int fill) {
  alignas(KeptBake) std::byte place[sizeof(KeptBake)];
  volatile std::byte* p = place;
  for (size_t i = 0; i < sizeof(place); ++i) p[i] = std::byte(fill);
  KeptBake* kept = new (place) KeptBake;
  kept->scene = some_bake().scene;
  const Bytes out = bytes_of(*kept);
  std::destroy_at(kept);
  return out;
}

// Rays and light know each other by a digest of a bake's bytes.
TEST(KeptBake, OfTheSameSceneHasTheSameBytes) { EXPECT_TRUE(bytes_over(0) == bytes_over(0xff)); }

TEST(Places, AreDigestsOfPositionAndNormals) {
  transport::Elements e;
  e.position = {{1, 2, 3}, {1, 2, 3}, {1, 2, 4}, {1, 2, 3}, {1, 2, 3}};
  e.normal = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  e.geometric_normal = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<uint64_t> places = places_of(e);
  EXPECT_EQ(places[0], places[1]);
  for (size_t i = 2; i < 5; ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_NE(places[i], places[j]) << i << " " << j;
}

TEST(LayersOfLights, AreThoseOfLampsAndOfInstancesThatShine) {
  scene::Scene scene;
  const uint32_t dark = scene::add_material(scene, "dark", {0.5f, 0.5f, 0.5f});
  const uint32_t shine = scene::add_material(scene, "shine", {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true, dark);
  scene::add_rectangle(scene, {0, 1, 0, 1}, 1, true, shine);
  scene.lights.resize(3);
  scene.lights[0].name = "a", scene.lights[1].name = "off", scene.lights[2].name = "b";
  scene.lights[1].intensity = {};
  scene.background = {1, 1, 1};
  const light::Lights lights = light::collect_lights(scene);
  const auto layers = light::light_layers(scene, lights, light::LayerMode::per_light);
  ASSERT_TRUE(layers);
  const LayersOfLights found = layers_of_lights(scene, lights, *layers);
  constexpr uint8_t kNone = LayersOfLights::kNoLayer;
  // Lamps first, then what shines, then the surroundings; lights without power are left out.
  EXPECT_EQ(found.of_punctual, (std::vector<uint8_t>{0, kNone, 1}));
  EXPECT_EQ(found.of_instance, (std::vector<std::vector<uint8_t>>{{}, {2}}));
  EXPECT_EQ(found.of_surroundings, 3);
}

}  // namespace
}  // namespace luxel::pipeline
