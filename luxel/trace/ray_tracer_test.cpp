#include "luxel/trace/ray_tracer.h"

#include <gtest/gtest.h>

#include <optional>

#include "luxel/base/random.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/procedural.h"
#include "luxel/scene/sides.h"
#include "luxel/trace/surface_starts_test_support.h"

namespace luxel::trace {
namespace {

scene::Mesh unit_quad() {
  scene::Mesh quad;
  quad.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  quad.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  quad.triangles = {{0, 1, 2}, {0, 2, 3}};
  quad.triangle_material = {0, 0};
  return quad;
}

scene::Scene quad_scene(Mat34 world_from_object = {}) {
  scene::Scene scene;
  scene.materials.push_back({});
  scene.meshes.push_back(unit_quad());
  scene.instances.push_back({"quad", 0, world_from_object});
  return scene;
}

TEST(RayTracer, HitsWhereThePlaneIs) {
  const scene::Scene scene = quad_scene();
  const auto tracer = RayTracer::build(scene);
  const Hit hit = tracer->closest_hit({{0.75f, 0.25f, 2}, 0, {0, 0, -1}, INFINITY});
  ASSERT_TRUE(hit.found());
  EXPECT_FLOAT_EQ(hit.t, 2);
  EXPECT_FALSE(hit.back_face);
  const Vec3 p = scene::world_position(scene, hit.point());
  EXPECT_NEAR(p.x, 0.75f, 1e-6f);
  EXPECT_NEAR(p.y, 0.25f, 1e-6f);
  EXPECT_FALSE(tracer->closest_hit({{1.5f, 0.5f, 2}, 0, {0, 0, -1}, INFINITY}).found());
  EXPECT_FALSE(tracer->closest_hit({{0.5f, 0.5f, 2}, 0, {0, 0, -1}, 1.5f}).found());
}

// A sheet with two sides of its own is met on the side that the ray comes from, at the same place,
// and never from behind; also where the other triangle comes first, and in mirrored instances.
TEST(RayTracer, MeetsTheSideThatTheRayComesFrom) {
  for (const Vec3 scale : {Vec3{1, 1, 1}, Vec3{-1, 1, 1}}) {
    scene::Scene scene = quad_scene(scaling(scale));
    scene::add_backs(scene, 0, std::vector<uint8_t>{1, 1});
    scene.instances.push_back({"elsewhere", 0, translation({0, 0, 50})});
    for (const size_t max_flat_triangles : {100, 0}) {
      const auto tracer = RayTracer::build(scene, max_flat_triangles);
      for (const float z : {1.0f, -1.0f}) {
        const Vec3 from{0.6f * scale.x, 0.3f, z};
        const Hit hit = tracer->closest_hit({from, 0, {0, 0, -z}, 10});
        ASSERT_TRUE(hit.found());
        EXPECT_FALSE(hit.back_face);
        EXPECT_EQ(hit.triangle >= 2, z < 0);
        EXPECT_GT(scene::front_normal(scene, hit.instance, hit.triangle).z * z, 0.99f);
        const Vec3 p = scene::world_position(scene, hit.point());
        EXPECT_LT(length(p - Vec3{from.x, from.y, 0}), 1e-5f);
      }
    }
  }
}

TEST(RayTracer, KnowsTheBackEvenOfMirroredInstances) {
  for (const Vec3 scale : {Vec3{1, 1, 1}, Vec3{-1, 1, 1}, Vec3{2, -3, 1}, Vec3{-1, -1, 1}}) {
    scene::Scene scene = quad_scene(translation({5, 0, 0}) * scaling(scale));
    scene.instances.push_back({"elsewhere", 0, translation({0, 0, 50})});
    const Vec3 middle = Vec3{5, 0, 0} + Vec3{0.4f * scale.x, 0.4f * scale.y, 0};
    // Each instance a copy in the top level, then both sharing one mesh.
    for (const size_t max_flat_triangles : {100, 0}) {
      const auto tracer = RayTracer::build(scene, max_flat_triangles);
      const Hit front = tracer->closest_hit({middle + Vec3{0, 0, 1}, 0, {0, 0, -1}, INFINITY});
      const Hit back = tracer->closest_hit({middle - Vec3{0, 0, 1}, 0, {0, 0, 1}, INFINITY});
      ASSERT_TRUE(front.found() && back.found());
      EXPECT_FALSE(front.back_face) << scale.x << " " << scale.y;
      EXPECT_TRUE(back.back_face) << scale.x << " " << scale.y;
      EXPECT_EQ(front.instance, 0u);
      EXPECT_GT(scene::front_normal(scene, 0, front.triangle).z, 0.99f);
      const Hit other = tracer->closest_hit({{0.5f, 0.5f, 51}, 0, {0, 0, -1}, INFINITY});
      EXPECT_EQ(other.instance, 1u);
    }
  }
}

TEST(RayTracer, HolesOfAMaskDoNotBlock) {
  scene::Scene scene = quad_scene();
  scene::Texture mask;
  mask.width = 2, mask.height = 1;
  mask.rgba = {255, 255, 255, 0, 255, 255, 255, 255};  // left half: a hole
  scene.textures.push_back(mask);
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.filter = scene::Filter::nearest;
  scene.materials[0].alpha_mode = scene::AlphaMode::mask;
  const auto tracer = RayTracer::build(scene);
  const Ray left{{0.25f, 0.5f, 1}, 0, {0, 0, -1}, INFINITY},
      right{{0.75f, 0.5f, 1}, 0, {0, 0, -1}, INFINITY};
  EXPECT_FALSE(tracer->closest_hit(left).found());
  EXPECT_TRUE(tracer->closest_hit(right).found());
  uint8_t blocked[2];
  const Ray rays[2] = {left, right};
  tracer->occluded(rays, blocked);
  EXPECT_EQ(blocked[0], 0);
  EXPECT_EQ(blocked[1], 1);
}

// A closed sphere around the origin: whatever the direction, also exactly through edges and
// corners, no ray may slip out between two triangles. 37 rays: two packets and a rest.
TEST(RayTracer, NothingSlipsThroughAClosedSurface) {
  const scene::Scene scene = scene::inward_sphere(1, 3, {0.5f, 0.5f, 0.5f}, {});
  const auto tracer = RayTracer::build(scene);
  const scene::Mesh& mesh = scene.meshes[0];
  std::vector<Ray> rays;
  for (const Vec3& corner : mesh.positions) rays.push_back({{}, 0, corner, INFINITY});
  for (const auto& t : mesh.triangles)
    rays.push_back({{}, 0, mesh.positions[t[0]] + mesh.positions[t[1]], INFINITY});
  RandomStream random{3};
  while (rays.size() % 16 != 5)
    rays.push_back(
        {{}, 0, {random.next() - 0.5f, random.next() - 0.5f, random.next() - 0.5f}, INFINITY});
  std::vector<Hit> hits(rays.size());
  tracer->closest_hits(rays, hits);
  for (size_t i = 0; i < hits.size(); ++i) {
    ASSERT_TRUE(hits[i].found()) << "ray " << i;
    EXPECT_FALSE(hits[i].back_face);
  }
}

// No ray meets the plane that it leaves: not its own triangle, not the other half of its quad, not
// a coplanar copy of that with other triangles. Starts lie no further off it than they must.
TEST(OffSurface, LeavesItsQuad) {
  for (const testing::QuadAndCopy& on : testing::quads_with_copies()) {
    const std::vector<Ray> rays = testing::rays_off(on);
    std::vector<Hit> hits(rays.size());
    const RayTracer tracers[] = {*RayTracer::build(on.scene), *RayTracer::build(on.scene, 0),
                                 *RayTracer::build_apart(on.scene)};
    for (const RayTracer& tracer : tracers) {
      tracer.closest_hits(rays, hits);
      EXPECT_EQ(std::ranges::count_if(hits, [](const Hit& h) { return h.instance < 2; }), 0)
          << on.name;
    }
    const scene::Triangle3 t = scene::world_triangle(on.scene, 0, 0);
    const DVec3 a = to_double(t.a);
    const DVec3 n = normalize(cross(to_double(t.b) - a, to_double(t.c) - a));
    const float size_m = scene::facet_of(on.scene, 0, 0).size_m;
    for (const Ray& ray : rays) {
      const double height = dot(to_double(ray.origin) - a, n);
      const double most =
          0x1p-20 * double(std::max(max_component(max(ray.origin, -ray.origin)), size_m));
      EXPECT_GT(height, 0) << on.name;
      EXPECT_LT(height, most) << on.name;
    }
  }
}

/// Packets of neighbouring directions from one place, across octants and along axes, too; the last
/// packet is not full.
std::vector<Ray> bundle_from(Vec3 origin, RandomStream& random) {
  std::vector<Ray> rays;
  for (int k = 0; k < 64; ++k) {
    const bool along_axes = k % 8 == 0;
    const Vec3 centre =
        along_axes ? Vec3{k % 16 == 0 ? 1.0f : 0, 0, k % 16 == 0 ? 0 : -1.0f}
                   : Vec3{random.next() - 0.5f, random.next() - 0.5f, random.next() - 0.5f};
    for (int i = 0; i < 16; ++i) {
      const Vec3 step{float(i % 4) - 1.5f, float(i / 4) - 1.5f, along_axes ? 0.0f : float(i % 3)};
      rays.push_back({origin, 0, centre + step * 0.05f, INFINITY});
    }
  }
  rays.resize(rays.size() - 5);
  return rays;
}

// Embree's traversal for bundles must end, and meet what the other one meets.
TEST(RayTracer, BundlesMeetWhatSingleRaysMeet) {
  scene::Scene scene = scene::spheres_and_cube();
  scene::Mesh soup;
  RandomStream random{11};
  const auto place = [&] { return Vec3{random.next(), random.next(), random.next()} * 4; };
  for (uint32_t t = 0; t < 2000; ++t) {
    const Vec3 a = place();
    soup.positions.insert(soup.positions.end(), {a, a + place() * 0.05f, a + place() * 0.05f});
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    soup.triangle_material.push_back(0);
  }
  scene.meshes.push_back(soup);
  scene.instances.push_back({"soup", uint32_t(scene.meshes.size() - 1), {}});
  const auto tracer = RayTracer::build(scene);
  size_t other = 0, count = 0;
  for (int n = 0; n < 400; ++n) {
    const std::vector<Ray> rays = bundle_from(place(), random);
    std::vector<Hit> bundled(rays.size()), single(rays.size());
    tracer->closest_hits(rays, bundled, Packets::bundles);
    tracer->closest_hits(rays, single);
    for (size_t i = 0; i < rays.size(); ++i, ++count)
      // A ray through an edge may meet either side of it; the place is the same.
      if (bundled[i].found() != single[i].found() ||
          (single[i].found() && std::abs(bundled[i].t - single[i].t) > 1e-4f * single[i].t))
        ++other;
  }
  EXPECT_GT(count, 400000u);
  EXPECT_LE(other, count / 100000) << "rays along edges";
}

/// Panes one behind the other, at z = -1, -2, ..., 2 m wide, over two triangles each.
scene::Scene panes(const std::vector<scene::Material>& materials) {
  scene::Scene scene;
  for (const scene::Material& material : materials) {
    const float z = -1 - float(scene.meshes.size());
    scene.materials.push_back(material);
    scene::Mesh mesh;
    mesh.positions = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.triangle_material.assign(2, uint32_t(scene.meshes.size()));
    scene.meshes.push_back(mesh);
    scene.instances.push_back({"pane", uint32_t(scene.meshes.size() - 1), {}});
  }
  return scene;
}

scene::Material film(Rgb color, float alpha) {
  scene::Material m;
  m.alpha_mode = scene::AlphaMode::blend;
  m.base_color = color, m.alpha = alpha;
  return m;
}

scene::Material glass(Rgb color, float transmission) {
  scene::Material m;
  m.base_color = color, m.transmission = transmission;
  return m;
}

std::vector<Ray> rays_through_panes(size_t count, float t_max) {
  RandomStream random{3};
  std::vector<Ray> rays;
  for (size_t k = 0; k < count; ++k) {
    const Vec2 u = random.next2(), v = random.next2();
    const Vec3 from{u.x - 0.5f, u.y - 0.5f, 0};
    rays.push_back({from, 0, {0.1f * (v.x - 0.5f), 0.1f * (v.y - 0.5f), -1}, t_max});
  }
  return rays;
}

// (1 - coverage) tint of each pane: of the film 0.75 (1 - 0.25 (1 - c)), of the glass 0.8 c.
TEST(RayTracer, LightComesThroughGlassInItsColour) {
  const scene::Scene scene = panes({film({1, 0.5f, 0}, 0.25f), glass({0.5f, 1, 1}, 0.8f)});
  const auto tracer = RayTracer::build(scene);
  EXPECT_TRUE(tracer->has_tints());
  for (const auto& [t_max, expected] :
       {std::pair{1.5f, Rgb{0.75f, 0.75f * 0.875f, 0.75f * 0.75f}},
        {5.0f, Rgb{0.75f * 0.4f, 0.75f * 0.875f * 0.8f, 0.75f * 0.75f * 0.8f}}}) {
    const std::vector<Ray> rays = rays_through_panes(1000, t_max);
    std::vector<Rgb> share(rays.size());
    tracer->transmitted(rays, share);
    for (const Rgb& s : share) EXPECT_LE(length(s - expected), 1e-6f);
  }
}

TEST(RayTracer, NothingComesThroughAWallBehindGlass) {
  const scene::Scene scene = panes({film({1, 1, 1}, 0.1f), {}, film({1, 1, 1}, 0)});
  const auto tracer = RayTracer::build(scene);
  const std::vector<Ray> rays = rays_through_panes(100, 10);
  std::vector<Rgb> share(rays.size());
  tracer->transmitted(rays, share);
  for (const Rgb& s : share) EXPECT_EQ(s, (Rgb{}));
}

TEST(RayTracer, CoversStopEveryRay) {
  scene::Material hole;
  hole.alpha_mode = scene::AlphaMode::mask, hole.alpha = 0.1f;
  const scene::Scene scene = panes({hole, film({1, 0.5f, 0}, 0), film({1, 0.5f, 0}, 0.01f), {}});
  const auto tracer = RayTracer::build(scene);
  const std::vector<Ray> rays = rays_through_panes(1000, INFINITY);
  std::vector<Hit> hits(rays.size());
  tracer->closest_covers(rays, hits);
  for (const Hit& hit : hits) EXPECT_EQ(hit.instance, 2u);
}

// As many rays stop as the pane covers, and those that go on carry the tints of what they passed.
TEST(RayTracer, RaysStopAtGlassByItsCoverage) {
  const scene::Scene scene = panes({film({1, 0.5f, 0}, 0.25f), glass({0.5f, 1, 1}, 0.8f), {}});
  const auto tracer = RayTracer::build(scene);
  constexpr size_t kRays = 40000;
  const std::vector<Ray> rays = rays_through_panes(kRays, INFINITY);
  std::vector<Hit> hits(kRays);
  tracer->closest_hits(rays, hits);
  std::vector<Rgb> tint(kRays, {1, 1, 1});
  tracer->tint(rays, hits, tint);
  std::array<double, 3> stopped{};
  const Rgb film_tint{1, 0.875f, 0.75f};
  for (size_t k = 0; k < kRays; ++k) {
    ASSERT_TRUE(hits[k].found());
    stopped[hits[k].instance] += 1.0 / kRays;
    const Rgb expected = hits[k].instance == 0   ? Rgb{1, 1, 1}
                         : hits[k].instance == 1 ? film_tint
                                                 : film_tint * Rgb{0.5f, 1, 1};
    EXPECT_LE(length(tint[k] - expected), 1e-6f);
  }
  // Four standard deviations of a share of 40,000 rays: 0.0100.
  EXPECT_NEAR(stopped[0], 0.25, 0.01);
  EXPECT_NEAR(stopped[1], 0.75 * 0.2, 0.01);
  EXPECT_NEAR(stopped[2], 0.75 * 0.8, 0.01);
  std::vector<Hit> again(kRays);
  tracer->closest_hits(rays, again);
  for (size_t k = 0; k < kRays; ++k) ASSERT_EQ(hits[k].instance, again[k].instance);
}

// High quality trees divide long triangles among boxes, which must not tint twice.
TEST(RayTracer, ATriangleTintsOnce) {
  scene::Scene scene = panes({film({0, 0, 0}, 0.5f)});
  // A long, thin, slanted triangle among many small ones.
  scene::Mesh& mesh = scene.meshes[0];
  RandomStream random{5};
  for (uint32_t k = 0; k < 3000; ++k) {
    const auto base = uint32_t(mesh.positions.size());
    const Vec3 at{4 * random.next() - 2, 4 * random.next() - 2, 3 + random.next()};
    mesh.positions.insert(mesh.positions.end(),
                          {at, at + Vec3{0.01f, 0, 0.01f}, at + Vec3{0, 0.01f, 0}});
    mesh.triangles.push_back({base, base + 1, base + 2});
    mesh.triangle_material.push_back(0);
  }
  const auto base = uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(),
                        {Vec3{-3, -3, -4}, Vec3{3, 2.9f, 4.1f}, Vec3{3, 3, 4}});
  mesh.triangles.push_back({base, base + 1, base + 2});
  mesh.triangle_material.push_back(0);
  const auto tracer = RayTracer::build(scene);
  size_t met = 0;
  for (int k = 0; k < 4000; ++k) {
    const float along = random.next(), across = random.next() * along;
    const Vec3 target =
        Vec3{-3, -3, -4} + Vec3{6, 5.9f, 8.1f} * along + Vec3{0, 0.1f, -0.1f} * across;
    const Vec3 away =
        normalize(Vec3{0.3f, -1, 0.7f} + Vec3{random.next(), 0, random.next()} * 0.1f);
    const Ray ray{target + away * 0.2f, 0, -away, 0.4f};
    Rgb share;
    tracer->transmitted({&ray, 1}, {&share, 1});
    if (share.x == 1) continue;  // past its edge by rounding
    ++met;
    // Half of 0.5 for each surface: a quarter, or a sixteenth past one of the small ones.
    EXPECT_TRUE(share.x == 0.25f || share.x == 0.0625f) << share.x;
  }
  EXPECT_GT(met, 3800u);
}

/// The quad in the plane z = 0, and boxes above, across and beside it, also turned by 45 degrees.
TEST(RayTracer, KnowsEmptyBoxes) {
  const scene::Scene scene = quad_scene(translation({10, 0, 0}));
  const auto tracer = RayTracer::build(scene);
  const auto all = [](uint32_t, uint32_t) { return true; };
  const std::array<Vec3, 3> straight{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const float r = std::sqrt(0.5f);
  const std::array<Vec3, 3> turned{{{r, r, 0}, {-r, r, 0}, {0, 0, 1}}};
  EXPECT_TRUE(tracer->is_empty({{10.5f, 0.5f, 0.2f}, straight, {0.4f, 0.4f, 0.19f}}, all));
  EXPECT_FALSE(tracer->is_empty({{10.5f, 0.5f, 0.2f}, straight, {0.4f, 0.4f, 0.21f}}, all));
  EXPECT_TRUE(tracer->is_empty({{9.5f, 0.5f, 0}, straight, {0.49f, 0.1f, 0.1f}}, all));
  EXPECT_FALSE(tracer->is_empty({{9.5f, 0.5f, 0}, straight, {0.51f, 0.1f, 0.1f}}, all));
  // A box about the corner (10, 0): half of it along the diagonal reaches the quad.
  EXPECT_TRUE(tracer->is_empty({{9.8f, -0.2f, 0}, turned, {0.27f, 0.01f, 0.1f}}, all));
  EXPECT_FALSE(tracer->is_empty({{9.8f, -0.2f, 0}, turned, {0.29f, 0.01f, 0.1f}}, all));
  // Only the triangle that counts.
  const TurnedBox lower_right{{10.9f, 0.1f, 0}, straight, {0.05f, 0.05f, 0.1f}};
  EXPECT_FALSE(tracer->is_empty(lower_right, [](uint32_t, uint32_t t) { return t == 0; }));
  EXPECT_TRUE(tracer->is_empty({{10.9f, 0.1f, 0}, turned, {0.05f, 0.05f, 0.1f}},
                               [](uint32_t, uint32_t t) { return t == 1; }));
}

/// A mask with holes, a sheet with two sides, a ball, and panes of film, some of them twice, one
/// mirrored, and one that is pressed flat: `away` moves them, each in another way.
scene::Scene mixed_scene(float away) {
  scene::Scene scene = scene::inward_sphere(0.7f, 2, {0.5f, 0.5f, 0.5f}, {});
  const auto add = [&](const scene::Mesh& mesh, scene::Material material) {
    scene.meshes.push_back(mesh);
    scene.meshes.back().triangle_material.assign(mesh.triangles.size(),
                                                 uint32_t(scene.materials.size()));
    scene.materials.push_back(std::move(material));
    return uint32_t(scene.meshes.size() - 1);
  };
  scene::Texture holes;
  holes.width = 2, holes.height = 1;
  holes.rgba = {255, 255, 255, 0, 255, 255, 255, 255};
  scene.textures.push_back(holes);
  scene::Material masked;
  masked.base_color_texture.texture = 0;
  masked.base_color_texture.filter = scene::Filter::nearest;
  masked.alpha_mode = scene::AlphaMode::mask;
  const uint32_t mask = add(unit_quad(), masked), sheet = add(unit_quad(), {}),
                 pane = add(unit_quad(), film({1, 0.5f, 0.7f * away}, 0.25f));
  scene::add_backs(scene, sheet, std::vector<uint8_t>{1, 1});
  const Mat34 turned = from_columns({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {});
  for (const uint32_t mesh : {0u, mask, sheet, pane})
    for (const float x : {-1.5f, 1.0f}) {
      const float at = float(scene.instances.size());
      const Vec3 to{x + 0.1f * at * away, 0.4f * at - 2 + away, 0.3f * at - 1 - 0.2f * away};
      const Vec3 size{x < 0 ? -1.0f : 1.5f, 1, 1 + 0.3f * away};
      const Mat34 place = translation(to) * scaling(size);
      scene.instances.push_back({"", mesh, away > 0 && x > 0 ? place * turned : place});
    }
  scene.instances.push_back({"flat", sheet, translation({0, 0, -2 - away}) * scaling({2, 2, 0})});
  return scene;
}

std::vector<Ray> rays_across(size_t count) {
  RandomStream random{17};
  const auto place = [&] {
    return Vec3{random.next(), random.next(), random.next()} * 6 - Vec3{3, 3, 3};
  };
  std::vector<Ray> rays;
  for (size_t k = 0; k < count; ++k) {
    const Vec3 from = place();
    rays.push_back({from, 0, place() - from, k % 3 ? 1.0f : INFINITY});
  }
  return rays;
}

/// Rays that meet something else, by more than rounding, of those that meet no film; and those by
/// which another share of light comes.
struct Differences {
  size_t hits = 0, shares = 0, met = 0;
};
Differences differences(const RayTracer& a, const RayTracer& b, const scene::Scene& scene) {
  const std::vector<Ray> rays = rays_across(20000);
  std::vector<Hit> hit_a(rays.size()), hit_b(rays.size());
  a.closest_hits(rays, hit_a), b.closest_hits(rays, hit_b);
  std::vector<Rgb> share_a(rays.size()), share_b(rays.size());
  a.transmitted(rays, share_a), b.transmitted(rays, share_b);
  Differences out;
  for (size_t i = 0; i < rays.size(); ++i) {
    out.shares += length(share_a[i] - share_b[i]) > 1e-5f;
    // Chance decides which rays pass a film, by the bits of each.
    const float stops = min_component(share_a[i]);
    if (stops > 0 && stops < 1) continue;
    const Hit &p = hit_a[i], &q = hit_b[i];
    const auto films = [&](const Hit& h) {
      return h.found() && scene::tints_light(scene::material_at(scene, h.point()));
    };
    if (films(p) || films(q)) continue;
    out.met += p.found();
    if (p.found() != q.found() || (p.found() && std::abs(p.t - q.t) > 1e-4f))
      ++out.hits;
    else if (p.found() && (p.instance != q.instance || p.triangle != q.triangle ||
                           p.back_face != q.back_face || std::abs(p.at.u - q.at.u) > 1e-3f))
      ++out.hits;
  }
  return out;
}

// A flat tracer of the scene as it is now is another way to the same answer.
TEST(RayTracer, MovedMeetsWhatATracerOfTheMovedSceneMeets) {
  const scene::Scene before = mixed_scene(0), after = mixed_scene(1);
  std::optional<RayTracer> apart = std::move(*RayTracer::build_apart(before));
  const auto flat_before = RayTracer::build(before), flat_after = RayTracer::build(after);
  const auto moved = apart->moved(after);
  ASSERT_TRUE(moved);
  const Differences there = differences(*apart, *flat_before, before);
  apart.reset();  // what is shared outlives it
  const Differences here = differences(*moved, *flat_after, after);
  for (const Differences& d : {there, here}) {
    EXPECT_GT(d.met, 5000u);
    // Rays through edges count, also those of films in the way.
    EXPECT_LE(d.hits, d.met / 500);
    EXPECT_LE(d.shares, 20u);
  }
  EXPECT_GT(differences(*flat_before, *flat_after, after).hits, 1000u) << "the scenes differ";
}

TEST(RayTracer, MovedSortsNoMeshAgain) {
  const scene::Scene before = mixed_scene(0), after = mixed_scene(1);
  size_t once = 0;
  for (const scene::Mesh& mesh : before.meshes) once += mesh.triangles.size();
  const size_t flat = before.meshes[before.instances.back().mesh].triangles.size();
  const auto apart = RayTracer::build_apart(before);
  EXPECT_EQ(apart->sorted_triangles(), once + flat) << "the instance that is pressed flat is alone";
  EXPECT_EQ(apart->moved(after)->sorted_triangles(), flat);
  EXPECT_EQ(RayTracer::build(before)->sorted_triangles(), scene::first_triangles(before).back());
}

}  // namespace
}  // namespace luxel::trace
