#include "luxel/pipeline/texels/two_sides.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "luxel/scene/shapes.h"

namespace luxel::pipeline {
namespace {

constexpr uint32_t kSheet = 0, kSolid = 1;  ///< materials: double-sided, one-sided

scene::Scene empty() {
  scene::Scene s;
  scene::add_material(s, "sheet", {0.5f, 0.5f, 0.5f});
  scene::add_material(s, "solid", {0.5f, 0.5f, 0.5f});
  s.materials[kSheet].double_sided = true;
  s.background = {1, 1, 1};
  return s;
}

/// A box without its top (+y) or bottom, or whole.
scene::Mesh box(Vec3 lower, Vec3 upper, uint32_t material, float without_y = 0) {
  scene::Mesh whole;
  scene::add_box(whole, lower, upper, material);
  scene::Mesh out = whole;
  out.triangles.clear(), out.triangle_material.clear();
  const float y = without_y > 0 ? upper.y : lower.y;
  for (const auto& t : whole.triangles) {
    const bool in_plane =
        std::all_of(t.begin(), t.end(), [&](uint32_t v) { return whole.positions[v].y == y; });
    if (without_y != 0 && in_plane) continue;
    out.triangles.push_back(t), out.triangle_material.push_back(material);
  }
  return out;
}

void turn_inside_out(scene::Mesh& mesh) {
  for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
}

/// As exporters leave flat shaded meshes: no triangle shares a vertex.
scene::Mesh with_own_corners(const scene::Mesh& mesh) {
  scene::Mesh out;
  for (const auto& t : mesh.triangles) {
    const auto n = uint32_t(out.positions.size());
    for (const uint32_t v : t) out.positions.push_back(mesh.positions[v]);
    out.triangles.push_back({n, n + 1, n + 2});
  }
  out.triangle_material = mesh.triangle_material;
  return out;
}

/// The share of a mesh's triangles that need a back.
double open_share(const scene::Scene& scene, size_t mesh = 0) {
  Progress progress;
  const auto open = open_backs(scene, progress);
  EXPECT_TRUE(open);
  const std::vector<uint8_t>& flags = (*open)[mesh];
  if (flags.empty()) return 0;
  EXPECT_EQ(flags.size(), scene.meshes[mesh].triangles.size());
  return double(std::count(flags.begin(), flags.end(), 1)) / double(flags.size());
}

double share_of(scene::Mesh mesh) {
  scene::Scene s = empty();
  scene::place(s, std::move(mesh));
  return open_share(s);
}

TEST(TwoSides, SheetsAndOpenBoxesHaveBacksAndClosedSolidsHaveNone) {
  scene::Mesh sheet;
  scene::add_quad(sheet, {Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, kSheet);
  EXPECT_EQ(share_of(sheet), 1);
  EXPECT_EQ(share_of(box({}, {1, 1, 1}, kSheet, 1)), 1);
  EXPECT_EQ(share_of(box({}, {1, 1, 1}, kSheet)), 0);
  EXPECT_EQ(share_of(with_own_corners(box({}, {1, 1, 1}, kSheet))), 0);
  EXPECT_EQ(share_of(scene::sphere("ball", 1, 16, 8, kSheet)), 0);
  EXPECT_EQ(share_of(box({}, {1, 1, 1}, kSolid, 1)), 0);  // one-sided
}

// The walls of a room in the void: outside is nothing but the dark, unless there is a sky, a sun or
// a lamp.
TEST(TwoSides, WallsHaveAnOutsideWhereLightIsOutside) {
  scene::Scene s = empty();
  scene::Mesh room = box({-2, 0, -2}, {2, 3, 2}, kSheet);
  turn_inside_out(room);
  scene::place(s, std::move(room));
  EXPECT_EQ(open_share(s), 1);
  s.background = {};
  EXPECT_EQ(open_share(s), 0);
  s.environment = {.width = 1, .height = 1, .radiance = {{1, 1, 1}}};
  EXPECT_EQ(open_share(s), 1);
  s.environment = {};
  scene::PunctualLight lamp;
  lamp.position = {0, 1, 0};
  s.lights.push_back(lamp);
  EXPECT_EQ(open_share(s), 0);  // inside, where the fronts are
  s.lights[0].position = {5, 4, 7};
  EXPECT_EQ(open_share(s), 1);
  s.lights[0] = {};
  s.lights[0].kind = scene::PunctualLight::Kind::directional;
  EXPECT_EQ(open_share(s), 1);
}

// Both in one mesh: each shell for itself.
TEST(TwoSides, ShellsOfAMeshAreToldApart) {
  scene::Mesh both = box({}, {1, 1, 1}, kSheet);
  scene::add_quad(both, {Vec3{3, 0, 0}, {4, 0, 0}, {4, 1, 0}, {3, 1, 0}}, kSheet);
  EXPECT_NEAR(share_of(both), 2.0 / 14, 1e-12);
}

TEST(TwoSides, WhatIsShutByAFloorHasNone) {
  for (const uint32_t floor : {kSolid, kSheet}) {
    scene::Scene s = empty();
    scene::place(s, box({-0.5f, 0, -0.5f}, {0.5f, 2, 0.5f}, kSheet, -1));  // a pillar
    scene::add_rectangle(s, {-5, 5, -5, 5}, 0, true, floor);
    EXPECT_EQ(open_share(s), 0);
    s.meshes[0] = {};
    scene::add_quad(s.meshes[0],
                    {Vec3{-1, 1e-3f, 1}, {1, 1e-3f, 1}, {1, 1e-3f, -1}, {-1, 1e-3f, -1}}, kSheet);
    EXPECT_EQ(open_share(s), 0);  // a rug
    for (Vec3& p : s.meshes[0].positions) p.y = 1;
    EXPECT_EQ(open_share(s), 1);  // a table top
  }
}

// A room whose walls are wound outwards, as models from CAD have it, is seen from behind.
TEST(TwoSides, ARoomThatIsWoundOutwardsIsLitInside) {
  scene::Scene s = empty();
  scene::place(s, box({-2, 0, -2}, {2, 3, 2}, kSheet));
  EXPECT_EQ(open_share(s), 0);  // nobody is in it
  s.lights.emplace_back();
  s.lights[0].position = {0, 9, 0};
  EXPECT_EQ(open_share(s), 0);  // the lamp is outside
  s.lights[0].position = {0, 2, 0};
  EXPECT_EQ(open_share(s), 1);
  s.lights.clear();
  scene::Scene with_shade = s;
  scene::add_rectangle(with_shade, {-0.2f, 0.2f, -0.2f, 0.2f}, 2, true, kSheet);
  EXPECT_EQ(open_share(with_shade, 1), 1);  // it sees nothing but backs
  scene::place(s, box({9, 0.5f, -1}, {11, 1, 1}, kSheet), translation({-10, 0, 0}));
  EXPECT_EQ(open_share(s), 1);
  EXPECT_EQ(open_share(s, 1), 0);  // a solid table
}

// Light from lamps in a room, where no walk finds the sky.
TEST(TwoSides, ASheetInAShutRoomHasABack) {
  scene::Scene s = empty();
  scene::Mesh room = box({-2, 0, -2}, {2, 3, 2}, kSolid);
  turn_inside_out(room);
  scene::place(s, std::move(room));
  scene::add_rectangle(s, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, true, kSheet);
  EXPECT_EQ(open_share(s, 1), 1);
  scene::Mesh booth = box({-1.5f, 0.5f, -1.5f}, {-1, 1, -1}, kSheet);
  turn_inside_out(booth);
  scene::place(s, std::move(booth));
  EXPECT_EQ(open_share(s, 2), 1);
}

// A pond at night that is wound downwards, with a lantern above it: what its upper side sees is
// nearly all dark, but the lantern shines on it.
TEST(TwoSides, ASheetUnderALanternHasABack) {
  scene::Scene s = empty();
  s.background = {};
  scene::Mesh pond;
  scene::add_quad(pond, {Vec3{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, kSheet);
  scene::place(s, std::move(pond));
  scene::place(s, box({-0.2f, 2, -0.2f}, {0.2f, 2.4f, 0.2f}, kSolid));
  s.materials[kSolid].emission = {5, 5, 5};
  EXPECT_EQ(open_share(s), 1);
}

TEST(TwoSides, WhatLiesInASolidHasNone) {
  scene::Scene s = empty();
  scene::place(s, box({-2, 0, -2}, {2, 3, 2}, kSolid));
  scene::add_rectangle(s, {-0.5f, 0.5f, -0.5f, 0.5f}, 1, true, kSheet);
  EXPECT_EQ(open_share(s, 1), 0);
}

// A board across a box, joined to its corners: what is shut stays so where the shell sees itself.
TEST(TwoSides, ABoxWithAPartitionIsShut) {
  scene::Mesh chambers = box({}, {1, 1, 1}, kSheet);
  scene::add_quad(chambers, {Vec3{0, 0, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 0}}, kSheet);
  EXPECT_EQ(share_of(chambers), 0);
}

// A lid that leaves a fortieth of the top open: walks of four steps from places of five sides get
// out by a chance of 4 / 40 / 6 or so, 1 in 60.
TEST(TwoSides, ABoxWithAJointIsShut) {
  scene::Scene s = empty();
  scene::place(s, box({}, {1, 1, 1}, kSheet, 1));
  scene::add_rectangle(s, {0, 0.975f, 0, 1}, 1, true, kSheet);
  EXPECT_EQ(open_share(s), 0);
}

// One of many places in the light is enough.
TEST(TwoSides, AMeshIsLookedAtInSeveralPlaces) {
  scene::Scene s = empty();
  scene::add_rectangle(s, {-9, 9, -9, 9}, 0, true, kSolid);
  scene::Mesh rug;
  scene::add_quad(rug, {Vec3{-1, 1e-3f, 1}, {1, 1e-3f, 1}, {1, 1e-3f, -1}, {-1, 1e-3f, -1}},
                  kSheet);
  scene::place(s, std::move(rug));
  s.instances.push_back(s.instances[1]);
  s.instances[2].world_from_object = translation({3, 0, 0});
  EXPECT_EQ(open_share(s, 1), 0);
  s.instances[2].world_from_object = translation({3, 1, 0});
  EXPECT_EQ(open_share(s, 1), 1);
}

// The hollow of a wall between two boxes, the inner one wound inwards, is closed.
TEST(TwoSides, TheHollowOfAWallHasNone) {
  scene::Scene s = empty();
  scene::Mesh inner = box({-2, 0, -2}, {2, 3, 2}, kSheet);
  turn_inside_out(inner);
  scene::place(s, std::move(inner));
  scene::place(s, box({-2.8f, -0.8f, -2.8f}, {2.8f, 3.8f, 2.8f}, kSheet));
  scene::place(s, box({-1, 0.5f, -1}, {1, 1, 1}, kSheet));
  EXPECT_EQ(open_share(s, 0), 0);
  EXPECT_EQ(open_share(s, 1), 0);  // it holds the inner one, of which it sees backs alone
  EXPECT_EQ(open_share(s, 2), 0);
}

TEST(TwoSides, WhatScattersLightThroughHasTwoSidesInAnyCase) {
  scene::Scene s = empty();
  s.materials[kSolid].diffuse_transmission = 0.5f;
  scene::place(s, box({}, {1, 1, 1}, kSolid));
  EXPECT_EQ(open_share(s), 1);
}

TEST(TwoSides, SidesAreSplitOnce) {
  scene::Scene s = empty();
  s.materials[kSheet].diffuse_transmission = 0.5f;
  scene::add_rectangle(s, {-1, 1, -1, 1}, 0, true, kSheet);
  for (int k = 0; k < 2; ++k) {
    Progress progress;
    EXPECT_TRUE(split_sides(s, {.uv = atlas::UvMode::unwrap}, progress));
    EXPECT_EQ(s.meshes[0].triangles.size(), 4u);
  }
}

/// True where the triangles of a mesh are one-sided once sides are split.
bool is_one_sided(scene::Scene s) {
  const size_t triangles = s.meshes[0].triangles.size();
  Progress progress;
  EXPECT_TRUE(split_sides(s, {.uv = atlas::UvMode::unwrap}, progress));
  const scene::Mesh& mesh = s.meshes[0];
  return mesh.triangles.size() == triangles &&
         std::ranges::none_of(mesh.triangle_material,
                              [&](uint32_t m) { return s.materials[m].double_sided; });
}

TEST(TwoSides, SolidsAreOneSided) {
  scene::Scene s = empty();
  scene::place(s, box({}, {1, 1, 1}, kSheet));
  EXPECT_TRUE(is_one_sided(s));
  // Mirrored, its front is outside all the same.
  s.instances[0].world_from_object = from_columns({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {});
  EXPECT_TRUE(is_one_sided(s));
  scene::Scene glass = s;
  glass.materials[kSheet].transmission = 1;
  EXPECT_FALSE(is_one_sided(glass));
  // A room in the dark is seen from inside, and a bowl upside down on a floor is no solid.
  scene::Scene room = s;
  room.background = {};
  turn_inside_out(room.meshes[0]);
  EXPECT_FALSE(is_one_sided(room));
  scene::Scene bowl = empty();
  scene::place(bowl, box({}, {1, 1, 1}, kSheet, -1));
  scene::add_rectangle(bowl, {-5, 5, -5, 5}, 0, true, kSolid);
  EXPECT_FALSE(is_one_sided(bowl));
}

TEST(TwoSides, NothingIsAskedOfASceneWithoutSheets) {
  scene::Scene s = empty();
  scene::place(s, box({}, {1, 1, 1}, kSolid));
  Progress progress;
  const auto open = open_backs(s, progress);
  ASSERT_TRUE(open);
  EXPECT_TRUE((*open)[0].empty());
}

}  // namespace
}  // namespace luxel::pipeline
