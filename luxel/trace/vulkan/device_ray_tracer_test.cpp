// A device meets what Embree meets, and what is known without either. Skipped without a device.
#include "luxel/trace/vulkan/device_ray_tracer.h"

#include <gmock/gmock.h>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/gpu/device_test_support.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/surface_starts_test_support.h"

namespace luxel::trace {
namespace {

using ::testing::IsEmpty;

class DeviceRays : public gpu::testing::OnDevice,
                   public ::testing::WithParamInterface<HierarchyKind> {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (device_ && !device_->has_ray_queries && GetParam() == HierarchyKind::driver)
      GTEST_SKIP() << device_->name << " has no ray queries";
  }
  DeviceRayTracer built(const scene::Scene& scene) {
    auto tracer = DeviceRayTracer::build(*device_, scene, GetParam());
    EXPECT_TRUE(tracer) << tracer.error().message;
    return std::move(*tracer);
  }
};

std::vector<Hit> hits_of(DeviceRayTracer& tracer, std::span<const Ray> rays) {
  std::vector<Hit> hits(rays.size());
  const Status done = tracer.closest_hits(rays, hits);
  EXPECT_TRUE(done) << done.error().message;
  return hits;
}

/// Rays from all over a scene's box in all directions.
std::vector<Ray> rays_within(const scene::Scene& scene, size_t count) {
  const Box3 box = scene::world_bounds(scene);
  const Vec3 size = box.upper - box.lower;
  RandomStream random{7};
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const Vec2 u = random.next2();
    const Vec3 from{box.lower.x + size.x * u.x, box.lower.y + size.y * u.y,
                    box.lower.z + size.z * random.next()};
    rays.push_back({from, 0, uniform_sphere_sample(random.next2()), INFINITY});
  }
  return rays;
}

scene::Scene scene_named(std::string_view file) {
  for (scene::NamedScene& named : scene::procedural_scenes())
    if (named.file == file) return std::move(named.scene);
  return {};
}

/// The unit square of z = 0, its front towards +z.
scene::Scene quad_scene(Mat34 world_from_object) {
  scene::Scene scene;
  scene.materials.push_back({});
  scene::Mesh quad;
  quad.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  quad.triangles = {{0, 1, 2}, {0, 2, 3}};
  quad.triangle_material = {0, 0};
  scene.meshes.push_back(quad);
  scene.instances.push_back({"quad", 0, world_from_object});
  return scene;
}

/// Rays that meet something, and those that meet another triangle or its other side.
struct Counts {
  size_t met = 0, other = 0;
};
/// Calls same(hit, expected) where both have met the same side of a triangle. What is met is
/// blocked.
template <class Same>
Counts compare(std::span<const Hit> hits, std::span<const Hit> expected,
               std::span<const uint8_t> blocked, const Same& same) {
  Counts out;
  for (size_t i = 0; i < hits.size(); ++i) {
    out.met += expected[i].found();
    EXPECT_EQ(hits[i].found(), blocked[i] != 0);
    if (hits[i].instance != expected[i].instance || hits[i].triangle != expected[i].triangle ||
        hits[i].back_face != expected[i].back_face)
      ++out.other;
    else if (expected[i].found())
      same(hits[i], expected[i]);
  }
  return out;
}

// Rays that graze an edge may meet either side of it, and those that begin on a surface may meet it
// or not: one in a thousand at most. All others meet the same triangle at the same place, up to
// some roundings.
TEST_P(DeviceRays, MeetWhatTheProcessorsMeet) {
  for (const char* file : {"cornell-box.glb", "office.glb", "spheres-and-cube.glb"}) {
    const scene::Scene scene = scene_named(file);
    const std::vector<Ray> rays = rays_within(scene, 20000);
    DeviceRayTracer device = built(scene);
    const auto processor = RayTracer::build(scene);
    std::vector<Hit> expected(rays.size());
    processor->closest_hits(rays, expected);
    std::vector<uint8_t> blocked(rays.size());
    ASSERT_TRUE(device.occluded(rays, blocked));
    const std::vector<Hit> hits = hits_of(device, rays);
    const auto [met, other] = compare(hits, expected, blocked, [&](const Hit& a, const Hit& b) {
      const Vec3 p = scene::world_position(scene, a.point()),
                 q = scene::world_position(scene, b.point());
      EXPECT_LT(length(p - q), 1e-5f * (1 + scene::world_bounds(scene).diagonal())) << file;
      EXPECT_NEAR(a.t, b.t, 1e-5f * (1 + b.t)) << file;
    });
    EXPECT_GT(met, rays.size() / 2) << file;
    EXPECT_LE(other, rays.size() / 1000) << file;
  }
}

// As OffSurface.LeavesItsQuad has it of the processor: no ray meets the plane that it leaves. Every
// seventh of its quads.
TEST_P(DeviceRays, LeaveTheQuadsThatTheyStartFrom) {
  const std::vector<testing::QuadAndCopy> all = testing::quads_with_copies();
  for (size_t k = 0; k < all.size(); k += 7) {
    DeviceRayTracer tracer = built(all[k].scene);
    const std::vector<Hit> hits = hits_of(tracer, testing::rays_off(all[k]));
    EXPECT_EQ(std::ranges::count_if(hits, [](const Hit& h) { return h.instance < 2; }), 0)
        << all[k].name;
  }
}

// A closed sphere around the origin: no ray slips out between two triangles, also exactly through
// edges and corners. Drivers promise less: edges are all that Vulkan asks of them. lavapipe lets
// one ray in forty pass that is aimed exactly at a corner.
TEST_P(DeviceRays, DoNotSlipThroughAClosedSurface) {
  const scene::Scene scene = scene::inward_sphere(1, 4, {0.5f, 0.5f, 0.5f}, {});
  const scene::Mesh& mesh = scene.meshes[0];
  std::vector<Ray> at_edges, at_corners;
  for (const Vec3& corner : mesh.positions) at_corners.push_back({{}, 0, corner, INFINITY});
  for (const auto& t : mesh.triangles)
    at_edges.push_back({{}, 0, mesh.positions[t[0]] + mesh.positions[t[1]], INFINITY});
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}})
    at_edges.push_back({{}, 0, axis, INFINITY});
  DeviceRayTracer tracer = built(scene);
  for (const Hit& hit : hits_of(tracer, at_edges)) {
    EXPECT_TRUE(hit.found());
    EXPECT_FALSE(hit.back_face);
  }
  size_t missed = 0;
  for (const Hit& hit : hits_of(tracer, at_corners)) {
    missed += !hit.found();
    EXPECT_FALSE(hit.back_face);
  }
  EXPECT_LE(missed, GetParam() == HierarchyKind::driver ? at_corners.size() / 20 : 0);
}

// A quad that stands mirrored, a sheet with two sides, and ends of rays, as in RayTracer's own
// tests.
TEST_P(DeviceRays, KnowSidesAndEnds) {
  for (const float side : {1.0f, -1.0f}) {
    scene::Scene scene = quad_scene(scaling({side, 1, 1}));
    for (const bool two_sided : {false, true}) {
      if (two_sided) scene::add_backs(scene, 0, std::vector<uint8_t>{1, 1});
      DeviceRayTracer tracer = built(scene);
      const std::vector<Hit> hits =
          hits_of(tracer, std::vector<Ray>{{{0.75f * side, 0.25f, 2}, 0, {0, 0, -1}, INFINITY},
                                           {{0.75f * side, 0.25f, -2}, 0, {0, 0, 1}, INFINITY},
                                           {{0.75f * side, 0.25f, 2}, 0, {0, 0, -1}, 1.5f},
                                           {{0.75f * side, 0.25f, 2}, 2.5f, {0, 0, -1}, 9},
                                           {{1.5f * side, 0.25f, 2}, 0, {0, 0, -1}, INFINITY}});
      ASSERT_TRUE(hits[0].found() && hits[1].found());
      EXPECT_FLOAT_EQ(hits[0].t, 2);
      EXPECT_FALSE(hits[0].back_face);
      EXPECT_EQ(hits[1].back_face, !two_sided);
      EXPECT_EQ(hits[1].triangle >= 2, two_sided);
      for (const size_t k : {0, 1})
        EXPECT_LT(
            length(scene::world_position(scene, hits[k].point()) - Vec3{0.75f * side, 0.25f, 0}),
            1e-6f);
      for (const size_t k : {2, 3, 4}) EXPECT_FALSE(hits[k].found());
    }
  }
}

TEST_P(DeviceRays, MeetNothingWhereNothingIs) {
  const scene::Scene scene;
  DeviceRayTracer tracer = built(scene);
  const std::vector<Ray> rays{{{}, 0, {0, 0, -1}, INFINITY}, {{1, 2, 3}, 0, {1, 0, 0}, 5}};
  for (const Hit& hit : hits_of(tracer, rays)) EXPECT_FALSE(hit.found());
  EXPECT_THAT(hits_of(tracer, {}), IsEmpty());
}

/// A hundred copies of what a scene has, turned, mirrored, stretched and sheared, and one pressed
/// flat; among them a mesh that stands once.
scene::Scene with_copies(scene::Scene scene) {
  RandomStream random{23};
  const std::vector<scene::Instance> some = scene.instances;
  for (int k = 0; k < 100; ++k)
    for (scene::Instance instance : some) {
      const auto axis = [&] { return uniform_sphere_sample(random.next2()); };
      const Vec3 x = axis() * (0.2f + random.next()), y = axis() * (0.2f + random.next());
      const Vec3 z = k == 50 ? x + y : axis() * (0.2f + random.next());
      const Vec3 place{20 * random.next() - 10, 20 * random.next() - 10, 20 * random.next() - 10};
      instance.world_from_object = from_columns(x, y, z, place) * instance.world_from_object;
      scene.instances.push_back(instance);
    }
  const scene::Scene once = scene::inward_sphere(9, 3, {0.5f, 0.5f, 0.5f}, {});
  scene.meshes.push_back(once.meshes[0]);
  for (uint32_t& material : scene.meshes.back().triangle_material) material = 0;
  scene.instances.push_back({"once", uint32_t(scene.meshes.size() - 1), {}});
  return scene;
}

// Meshes that are stored once are met as copies of them are: the same triangles of the same
// instances, on the same side, at the same place. Copies that are nearly flat make ten times as
// much of roundings.
TEST_P(DeviceRays, MeetInstancesOfSharedMeshes) {
  scene::Scene scene = with_copies(scene_named("spheres-and-cube.glb"));
  std::vector<uint8_t> has_back(scene.meshes[0].triangles.size());
  for (size_t t = 0; t < has_back.size(); t += 2) has_back[t] = 1;
  scene::add_backs(scene, 0, has_back);
  const std::vector<Ray> rays = rays_within(scene, 20000);
  auto shared = DeviceRayTracer::build(*device_, scene, GetParam(), 0);
  ASSERT_TRUE(shared) << shared.error().message;
  DeviceRayTracer copies = built(scene);
  EXPECT_LT(shared->triangles(), copies.triangles() / 10);
  const std::vector<Hit> expected = hits_of(copies, rays), hits = hits_of(*shared, rays);
  std::vector<uint8_t> blocked(rays.size());
  ASSERT_TRUE(shared->occluded(rays, blocked));
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  const auto [met, other] = compare(hits, expected, blocked, [&](const Hit& a, const Hit& b) {
    const Vec3 p = scene::world_position(scene, a.point()),
               q = scene::world_position(scene, b.point());
    EXPECT_LT(length(p - q), 1e-4f * diagonal_m);
    EXPECT_NEAR(a.t, b.t, 1e-4f * diagonal_m);
  });
  EXPECT_GT(met, rays.size() / 3);
  EXPECT_LE(other, rays.size() / 1000);
}

// From far away, exactly at the edges of a small sphere, in whose space the rays begin hundreds of
// radii away. (At a corner roundings of all its edges may lead through, as they may in the world.)
TEST_P(DeviceRays, DoNotSlipThroughASharedSurface) {
  scene::Scene scene = scene::inward_sphere(1, 4, {0.5f, 0.5f, 0.5f}, {});
  const scene::Mesh& mesh = scene.meshes[0];
  const Vec3 place{30, 40, 50};
  const Mat34 world_from_object = translation(place) * scaling({0.1f, 0.1f, 0.1f});
  scene.instances[0].world_from_object = world_from_object;
  scene.instances.push_back({"other", 0, translation({-60, 0, 0})});
  auto tracer = DeviceRayTracer::build(*device_, scene, GetParam(), 0);
  ASSERT_TRUE(tracer) << tracer.error().message;
  std::vector<Ray> rays;
  const auto add = [&](Vec3 p) {
    const Vec3 target = transform_point(world_from_object, p);
    // Not near its rim, where roundings may lead past it.
    if (dot(normalize(target - place), normalize(place)) < -0.3f)
      rays.push_back({{}, 0, target, INFINITY});
  };
  for (const auto& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k)
      add(0.5f * (mesh.positions[t[k]] + mesh.positions[t[(k + 1) % 3]]));
  EXPECT_GT(rays.size(), 1000u);
  for (const Hit& hit : hits_of(*tracer, rays)) {
    ASSERT_TRUE(hit.found());
    EXPECT_EQ(hit.instance, 0u);
    EXPECT_NEAR(hit.t, 1, 1e-4f);
  }
}

/// Three quads after each other in z: a mask that repeats, turned, a mirrored blend, and unfiltered
/// glass with metal in it; each with a texture of noise. Half of a fourth one blocks what is left.
scene::Scene see_through_scene(bool with_alphas = false) {
  scene::Scene scene = quad_scene({});
  scene::Mesh& quad = scene.meshes[0];
  if (with_alphas) quad.alphas = {1, 0.5f, 0.9f, 0.7f};
  quad.uv0 = {{-1.2f, 0.1f}, {1.7f, 0}, {2, 3}, {0.3f, 2.5f}};
  RandomStream random{11};
  for (const int size : {5, 8}) {
    scene::Texture t;
    t.width = size, t.height = size + 1;
    for (int i = 0; i < 4 * size * (size + 1); ++i) t.rgba.push_back(uint8_t(255 * random.next()));
    scene.textures.push_back(t);
  }
  scene.materials.resize(3, scene.materials[0]);
  scene::Material& mask = scene.materials[0];
  mask.alpha_mode = scene::AlphaMode::mask, mask.alpha = 0.9f;
  mask.base_color_texture.texture = 0, mask.base_color_texture.rotation = 0.4f;
  mask.base_color_texture.scale = {2, 3}, mask.base_color_texture.offset = {0.2f, -7};
  scene::Material& blend = scene.materials[1];
  blend.alpha_mode = scene::AlphaMode::blend;
  blend.base_color_texture.texture = 1;
  blend.base_color_texture.wrap_u = scene::Wrap::mirror;
  blend.base_color_texture.wrap_v = scene::Wrap::clamp;
  scene::Material& glass = scene.materials[2];
  glass.transmission = 0.8f, glass.metallic = 0.5f;
  glass.transmission_texture.texture = 1;
  glass.transmission_texture.filter = scene::Filter::nearest;
  glass.metallic_texture.texture = 0, glass.metallic_texture.uv_set = 1;  // there is none: 1
  for (uint32_t k = 1; k < 3; ++k) {
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[k].triangle_material = {k, k};
    scene.instances.push_back({"", k, translation({0, 0, -float(k)})});
  }
  scene.materials.push_back({});
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[3].triangle_material = {3, 3};
  scene.instances.push_back({"wall", 3, translation({0.5f, 0, -3})});
  return scene;
}

// Both let the same rays pass: the same texels are looked up, and the same numbers drawn. A few lie
// within rounding of a mask's edge, of an unfiltered texel's, or of the number drawn.
void expect_the_same_chance(DeviceRayTracer& device, const scene::Scene& scene) {
  std::vector<Ray> rays;
  RandomStream random{5};
  for (int i = 0; i < 20000; ++i) {
    const Vec2 u = random.next2(), tilt = random.next2();
    rays.push_back({{u.x, u.y, 1}, 0, {0.1f * tilt.x - 0.05f, 0.1f * tilt.y - 0.05f, -1}, 9});
  }
  const std::vector<Hit> hits = hits_of(device, rays);
  const auto processor = RayTracer::build(scene);
  std::vector<Hit> expected(rays.size());
  processor->closest_hits(rays, expected);
  std::vector<uint8_t> blocked(rays.size());
  ASSERT_TRUE(device.occluded(rays, blocked));
  std::array<size_t, 5> met{};  // per quad, and nothing
  size_t others = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    ++met[expected[i].found() ? expected[i].instance : 4];
    others += hits[i].instance != expected[i].instance || hits[i].triangle != expected[i].triangle;
    EXPECT_EQ(blocked[i] != 0, hits[i].found());
  }
  for (const size_t times : met) EXPECT_GT(times, 500u);
  EXPECT_LE(others, 10u);
}

TEST_P(DeviceRays, PassSurfacesByTheSameChance) {
  for (const bool with_alphas : {false, true}) {
    const scene::Scene scene = see_through_scene(with_alphas);
    DeviceRayTracer device = built(scene);
    expect_the_same_chance(device, scene);
  }
}

// The chance follows from the ray in the world and the instance, also where the mesh is shared.
TEST_P(DeviceRays, PassSharedSurfacesByTheSameChance) {
  const scene::Scene scene = with_copies(see_through_scene());
  const std::vector<Ray> rays = rays_within(scene, 20000);
  auto shared = DeviceRayTracer::build(*device_, scene, GetParam(), 0);
  ASSERT_TRUE(shared) << shared.error().message;
  DeviceRayTracer copies = built(scene);
  const std::vector<Hit> expected = hits_of(copies, rays), hits = hits_of(*shared, rays);
  size_t met = 0, others = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    met += expected[i].found() && expected[i].instance + 1 < scene.instances.size();
    others += hits[i].instance != expected[i].instance;
  }
  EXPECT_GT(met, 200u);
  EXPECT_LE(others, 10u);
}

INSTANTIATE_TEST_SUITE_P(AllHierarchies, DeviceRays,
                         ::testing::Values(HierarchyKind::binary, HierarchyKind::wide,
                                           HierarchyKind::driver),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

}  // namespace
}  // namespace luxel::trace
