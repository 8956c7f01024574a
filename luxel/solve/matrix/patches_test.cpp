#include "luxel/solve/matrix/patches.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"

#include <algorithm>

#include "luxel/base/parallel.h"
#include "luxel/scene/off_surface.h"
#include "luxel/solve/matrix/matrix_test_support.h"

namespace luxel::matrix {
namespace {

using testing::Cut;

/// Sums of tens of thousands of floats in double: each sample's part of its area is rounded once.
constexpr double kFloatSum = 1e-5;

TEST(Patches, AreasSumToTheScenesArea) {
  // Nothing stands on a floor in these, so nothing is hidden.
  for (const scene::Scene& scene :
       {scene::cornell_box(scene::CornellColors::pbrt, false),
        scene::furnace_box({0.5f, 0.5f, 0.5f}, {}), scene::spheres_and_cube(), testing::plate(),
        scene::inward_sphere(2, 3, {0.5f, 0.5f, 0.5f}, {})}) {
    const Cut cut(scene, 500);
    const double area = testing::area_of(scene);
    EXPECT_NEAR(testing::sum_of(cut.patches().area_m2), area, kFloatSum * area) << scene.name;
  }
}

TEST(Patches, AreAsManyAsAskedFor) {
  for (const scene::Scene& scene :
       {scene::cornell_box(), scene::furnace_box({0.5f, 0.5f, 0.5f}, {}), scene::spheres_and_cube(),
        testing::plate(), testing::floor_with_wall()})
    for (const size_t wanted : {300u, 2000u})
      EXPECT_NEAR(double(Cut(scene, wanted, 24).size()), double(wanted), 0.15 * double(wanted))
          << scene.name;
}

TEST(Patches, FillTheirArraysAndTree) {
  const Cut cut(scene::cornell_box(), 500);
  const Patches& p = cut.patches();
  ASSERT_EQ(p.elements.size(), p.size());
  ASSERT_EQ(p.centroid.size(), p.size());
  ASSERT_EQ(p.emission.size(), p.size());
  ASSERT_EQ(p.first_point.size(), p.size() + 1);
  EXPECT_EQ(p.first_point.back(), p.points.size());
  ASSERT_EQ(cut.patched.tree.order.size(), p.size());
  for (uint32_t k = 0; k < p.size(); ++k) {
    EXPECT_EQ(cut.patched.tree.order[k], k);
    EXPECT_GT(p.area_m2[k], 0);
    EXPECT_GE(p.points_of(k).size(), 1u);
    EXPECT_NEAR(length(p.elements.normal[k]), 1, 1e-5);
    for (const PatchPoint& point : p.points_of(k))
      // A patch is one voxel of surface, or two with a sliver between: 3 diagonals at most.
      EXPECT_LT(length(point.position - p.elements.position[k]), 3 * 1.75f * p.voxel_m);
  }
}

TEST(Patches, SidesOfAThinWallAreApart) {
  const Cut cut(testing::floor_with_wall(), 200);
  for (size_t k = 0; k < cut.size(); ++k)
    for (const PatchPoint& point : cut.patches().points_of(k))
      EXPECT_GT(dot(point.normal, cut.patches().points_of(k)[0].normal), kSameDirection);
}

TEST(Patches, FloorIsCutByTheWallOnIt) {
  // A voxel is about 0.15 m wide: all along the wall there are some with floor on both sides.
  const Cut cut(testing::floor_with_wall(), 120);
  int left = 0, right = 0;
  for (size_t k = 0; k < cut.size(); ++k) {
    bool is_left = false, is_right = false;
    for (const PatchPoint& point : cut.patches().points_of(k)) {
      if (point.normal.y < 0.5f || point.position.y > 0.1f) continue;
      is_left |= point.position.x<0, is_right |= point.position.x> 0;
    }
    left += is_left, right += is_right;
    EXPECT_FALSE(is_left && is_right) << k;
  }
  EXPECT_GT(left, 10);
  EXPECT_GT(right, 10);
}

TEST(Patches, PointsOfAPatchSeeEachOther) {
  // In a scene of convex pieces whatever passes from patch to patch along the surface is in sight
  // but round the corner of a block, by slivers that joined: next to none.
  const Cut cut(scene::cornell_box(), 300);
  size_t pairs = 0, blocked = 0;
  for (size_t k = 0; k < cut.size(); ++k) {
    const auto points = cut.patches().points_of(k);
    for (size_t i = 0; i < points.size(); ++i, ++pairs)
      blocked += !see_each_other(cut.tracer, points[i], points[(i * 7 + 3) % points.size()],
                                 cut.patches().voxel_m);
  }
  EXPECT_LT(double(blocked), 0.005 * double(pairs)) << blocked << " of " << pairs;
}

TEST(Patches, ASmallLampKeepsItsAreaAndPower) {
  // 1 cm^2 of 1 m^2: a third of a point would fall on it.
  scene::Scene scene = testing::plate();
  const Rgb radiance{7, 5, 3};
  scene::add_rectangle(scene, {0.5f, 0.51f, 0.5f, 0.51f}, 0.5f, false,
                       scene::add_material(scene, "lamp", {}, radiance));
  const Cut cut(scene, 64);
  double area = 0, red = 0, blue = 0;
  for (size_t k = 0; k < cut.size(); ++k) {
    const double a = double(cut.patches().area_m2[k]);
    const Rgb e = cut.patches().emission[k];
    if (e.x > 0) area += a;
    red += a * double(e.x), blue += a * double(e.z);
  }
  // The corners of the lamp are floats: 0.01 m is known to 6e-8 / 0.01.
  EXPECT_NEAR(area, 1e-4, 2e-5 * 1e-4);
  EXPECT_NEAR(red, double(kPi) * 7 * 1e-4, 2e-5 * double(kPi) * 7e-4);
  EXPECT_NEAR(blue, double(kPi) * 3 * 1e-4, 2e-5 * double(kPi) * 3e-4);
}

// A double-sided box in a double-sided room: with flags for the room alone, which light is in, no
// point lies inside of the box, and its outside keeps all of its area.
TEST(Patches, BacksInsideClosedSolidsAreInNone) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene.materials[0].double_sided = true;
  scene::Mesh room, box;
  scene::add_box(room, {0, 0, 0}, {1, 1, 1}, 0);
  scene::add_box(box, {0.3f, 0.3f, 0.3f}, {0.7f, 0.7f, 0.7f}, 0);
  scene::place(scene, std::move(room)), scene::place(scene, std::move(box));
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  PatchParams params{.count = 200};
  params.open_backs = {std::vector<uint8_t>(12, 1), {}};
  Progress progress;
  const auto cut = make_patches(scene, *tracer, params, progress);
  ASSERT_TRUE(cut) << cut.error().message;
  double outside = 0;
  for (uint32_t k = 0; k < cut->patches.size(); ++k)
    for (const PatchPoint& p : cut->patches.points_of(k)) {
      const Vec3 d = p.position - Vec3{0.5f, 0.5f, 0.5f};
      if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) > 0.25f) continue;
      EXPECT_GT(dot(d, p.normal), 0);
      outside += double(cut->patches.area_m2[k]) / double(cut->patches.points_of(k).size());
    }
  EXPECT_NEAR(outside, 6 * 0.4 * 0.4, 0.01);
  // Rays inside the box meet no patch, not that of a wall behind; those beside it do.
  RandomStream random{1};
  for (int k = 0; k < 200; ++k) {
    const Vec3 d = uniform_sphere_sample(random.next2());
    const auto met = [&](Vec3 from) {
      return patch_met(*cut, scene, *tracer, tracer->closest_hit({from, 0, d, INFINITY}));
    };
    EXPECT_EQ(met({0.5f, 0.5f, 0.5f}), kNone);
    EXPECT_NE(met({0.15f, 0.15f, 0.15f}), kNone);
  }
}

TEST(Patches, HoldOneMaterialEach) {
  scene::Scene scene;
  const Rgb left{0.2f, 0.4f, 0.6f}, right{0.8f, 0.1f, 0.3f};
  scene::add_rectangle(scene, {-1, 0, 0, 1}, 0, true, scene::add_material(scene, "left", left));
  scene::add_rectangle(scene, {0, 1, 0, 1}, 0, true, scene::add_material(scene, "right", right));
  const Cut cut(scene, 100);
  for (size_t k = 0; k < cut.size(); ++k) {
    const Rgb want = cut.patches().centroid[k].x < 0 ? left : right;
    // A mean of equal numbers, summed in float.
    EXPECT_LT(length(cut.patches().elements.reflectance[k] - want), 1e-5f);
  }
}

/// The unit square with a picture of two texels, black at u < 1/2, white beyond.
scene::Scene black_and_white() {
  scene::Scene scene = testing::plate();
  scene.textures.push_back({"two", 2, 1, {0, 0, 0, 255, 255, 255, 255, 255}, {}, ""});
  scene.materials[0].base_color = {0.8f, 0.8f, 0.8f};
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].base_color_texture.filter = scene::Filter::nearest;
  scene.meshes[0].uv0.clear();
  for (const Vec3& p : scene.meshes[0].positions) scene.meshes[0].uv0.push_back({p.x, p.z});
  return scene;
}

TEST(Patches, ReflectWhatTheirTextureDoes) {
  const Cut cut(black_and_white(), 100);
  const float voxel_m = cut.patches().voxel_m;
  double mean = 0;
  for (size_t k = 0; k < cut.size(); ++k) {
    const float rho = cut.patches().elements.reflectance[k].x;
    const float x = cut.patches().centroid[k].x;
    mean += double(rho * cut.patches().area_m2[k]);
    if (std::abs(x - 0.5f) > 1.5f * voxel_m) {
      EXPECT_NEAR(rho, x < 0.5f ? 0 : 0.8f, 1e-5);
    }
  }
  // 4800 points in strata: the border is known to about one of 70 rows, 0.8 / 70 at the very most.
  EXPECT_NEAR(mean, 0.4, 0.008);
}

/// Number of the patches' points on the floor within 2 cm of a place.
size_t floor_points_at(const Cut& cut, float x, float z) {
  const std::vector<PatchPoint>& points = cut.patches().points;
  return size_t(std::count_if(points.begin(), points.end(), [&](const PatchPoint& p) {
    return p.normal.y > 0.9f && length(p.position - Vec3{x, 0, z}) < 0.02f;
  }));
}

TEST(Patches, FloorInsideASolidIsInNone) {
  const Cut cut(scene::cornell_box(), 1000);
  // The middles of the blocks' footprints (docs/bench/cornell-box.md), and places beside them.
  EXPECT_EQ(floor_points_at(cut, 0.1855f, 0.169f), 0u);
  EXPECT_EQ(floor_points_at(cut, 0.3685f, 0.35125f), 0u);
  EXPECT_GT(floor_points_at(cut, 0.05f, 0.05f), 10u);
  EXPECT_GT(floor_points_at(cut, 0.5f, 0.05f), 10u);
  double floor = 0;
  for (size_t k = 0; k < cut.size(); ++k)
    if (cut.patches().centroid[k].y < 1e-4f && cut.patches().elements.normal[k].y > 0.9f)
      floor += double(cut.patches().area_m2[k]);
  // Shoelace areas of the published corners. Only whole parts of voxels are hidden, but these have
  // the area of their points: within 2 %.
  const double short_block = 0.027633, tall_block = 0.027627, whole = 0.308231;
  EXPECT_NEAR(floor, whole - short_block - tall_block, 0.02 * whole);
}

// A rug as wide as twenty gaps over a floor of patches as large as that: neither the floor below it
// nor its underside is of any patch, and rays that end there meet none.
TEST(Patches, WhatARugCoversIsInNone) {
  constexpr float kGap_m = 0.01f, kBorder_m = 2 * kGap_m;
  scene::Scene scene = testing::plate();
  scene::add_rectangle(scene, {0.3f, 0.7f, 0.3f, 0.7f}, kGap_m, true, 0);
  scene.materials[0].double_sided = true;
  const Cut cut(scene, 60);
  double top = 0, floor = 0;
  for (uint32_t k = 0; k < cut.size(); ++k)
    for (const PatchPoint& p : cut.patches().points_of(k)) {
      const bool under = p.position.y < 0.5f * kGap_m;
      const bool inside = std::abs(p.position.x - 0.5f) < 0.2f - kBorder_m &&
                          std::abs(p.position.z - 0.5f) < 0.2f - kBorder_m;
      EXPECT_FALSE(inside && (under ? p.normal.y > 0 : p.normal.y < 0));
      const double area =
          double(cut.patches().area_m2[k]) / double(cut.patches().points_of(k).size());
      if (p.normal.y > 0) (under ? floor : top) += area;
    }
  // Areas, the floor's to within the border that is neither covered nor open; as that is 1.3 gaps
  // wide on all sides of the rug, 0.02 m^2.
  EXPECT_NEAR(top, 0.16, 0.01);
  EXPECT_NEAR(floor, 1 - 0.16 + 0.02, 0.01);
  const auto located = [&](Vec3 at, Vec3 n) {
    return cut.patched.locator.locate(scene::off_surface(at, n, 1), n, 0, cut.tracer);
  };
  for (const float x : {0.35f, 0.5f, 0.65f}) {
    EXPECT_EQ(located({x, 0, 0.5f}, {0, 1, 0}), kNone);
    EXPECT_EQ(located({x, kGap_m, 0.5f}, {0, -1, 0}), kNone);
    EXPECT_NE(located({x, kGap_m, 0.5f}, {0, 1, 0}), kNone);
    EXPECT_NE(located({x, 0, 0.25f}, {0, 1, 0}), kNone);
  }
}

TEST(PatchLocator, FindsEachPatchFromItsPoints) {
  for (const scene::Scene& scene :
       {scene::furnace_box({0.5f, 0.5f, 0.5f}, {}), scene::cornell_box(), scene::spheres_and_cube(),
        testing::floor_with_wall()}) {
    const Cut cut(scene, 500);
    size_t points = 0, found = 0;
    for (uint32_t k = 0; k < cut.size(); ++k)
      for (const PatchPoint& p : cut.patches().points_of(k))
        for (uint32_t m = 0; m < scene.materials.size(); ++m, ++points)
          found += cut.patched.locator.locate(p.position, p.normal, m, cut.tracer) == k;
    // Each point is of one material. Where parts of a voxel look alike and both are in sight, the
    // first one is taken: 2 % of points at the most.
    points /= scene.materials.size();
    EXPECT_GT(double(found), 0.98 * double(points)) << scene.name;
  }
}

TEST(PatchLocator, TellsTheFloorsBesideAWallApart) {
  const Cut cut(testing::floor_with_wall(), 120);
  for (int k = 0; k < 200; ++k)
    for (const float x : {-0.02f, 0.02f}) {
      const Vec3 at{x, 0, (float(k) + 0.5f) / 200};
      const uint32_t patch = cut.patched.locator.locate(at, {0, 1, 0}, 0, cut.tracer);
      ASSERT_NE(patch, kNone);
      EXPECT_GT(x * cut.patches().centroid[patch].x, 0) << at.x << ", " << at.z;
    }
}

TEST(PatchLocator, DoesNotLookOverWhatLiesJustAbove) {
  // A sheet one centimetre above one of two places: lifted by a twentieth of a voxel of one
  // metre, that place would lie above the sheet.
  scene::Scene scene = testing::plate();
  scene::add_rectangle(scene, {0.6f, 1, 0, 1}, 0.01f, true, 0);
  const auto tracer = trace::RayTracer::build(scene);
  ASSERT_TRUE(tracer);
  const PatchPoint open{{0.2f, 0, 0.5f}, {0, 1, 0}}, near{{0.5f, 0, 0.5f}, {0, 1, 0}},
      under{{0.8f, 0, 0.5f}, {0, 1, 0}};
  EXPECT_TRUE(see_each_other(*tracer, open, near, 1));
  EXPECT_FALSE(see_each_other(*tracer, open, under, 1));
}

Result<PatchedScene> try_to_cut(const scene::Scene& scene, size_t count, bool cancelled = false) {
  const auto tracer = trace::RayTracer::build(scene);
  Progress progress;
  if (cancelled) progress.request_cancel();
  return make_patches(scene, *tracer, {count, 8, 1}, progress);
}

TEST(Patches, RefuseASceneWithoutSurface) {
  const auto nothing = try_to_cut({}, 100);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::bad_input);
  scene::Scene scene = testing::plate();
  for (Vec3& p : scene.meshes[0].positions) p = {p.x, 0, p.x};
  const auto line = try_to_cut(scene, 100);
  ASSERT_FALSE(line);
  EXPECT_EQ(line.error().code, ErrorCode::bad_input);
}

TEST(Patches, PassTrianglesWithoutArea) {
  scene::Scene scene = testing::plate();
  scene::Mesh mesh;
  scene::add_triangle(mesh, {0, 1, 0}, {1, 1, 0}, {0.5f, 1, 0}, 0);
  scene::place(scene, std::move(mesh));
  const auto patched = try_to_cut(scene, 100);
  ASSERT_TRUE(patched);
  EXPECT_NEAR(testing::sum_of(patched->patches.area_m2), 1, kFloatSum);
}

TEST(Patches, LeaveOutWhatLiesInASolid) {
  // A cube, its fronts outwards, and a floor in it that no light reaches.
  scene::Scene scene;
  const uint32_t gray = scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  scene::Mesh box;
  scene::add_box(box, {0, 0, 0}, {1, 1, 1}, gray);
  scene::place(scene, std::move(box));
  scene::add_rectangle(scene, {0.2f, 0.8f, 0.2f, 0.8f}, 0.5f, true, gray);
  const Cut cut(scene, 100);
  // The cube stays, the floor in it goes.
  EXPECT_NEAR(testing::sum_of(cut.patches().area_m2), 6, 6 * kFloatSum);
}

TEST(Patches, RefuseABadCount) {
  for (const size_t count : {size_t(0), kMaxPatches + 1}) {
    const auto patched = try_to_cut(testing::plate(), count);
    ASSERT_FALSE(patched);
    EXPECT_EQ(patched.error().code, ErrorCode::bad_setting);
  }
}

TEST(Patches, CanBeCancelled) {
  const auto patched = try_to_cut(testing::plate(), 100, true);
  ASSERT_FALSE(patched);
  EXPECT_EQ(patched.error().code, ErrorCode::cancelled);
}

TEST(Patches, SameBitsForAnyNumberOfThreads) {
  const auto cut = [](int threads) {
    const ThreadLimit limit(threads);
    return Cut(scene::cornell_box(), 400, 24).patched.patches;
  };
  const Patches one = cut(1);
  for (const int threads : {2, 7}) {
    const Patches other = cut(threads);
    EXPECT_EQ(one.elements.position, other.elements.position);
    EXPECT_EQ(one.elements.reflectance, other.elements.reflectance);
    EXPECT_EQ(one.area_m2, other.area_m2);
    EXPECT_EQ(one.emission, other.emission);
    EXPECT_EQ(one.first_point, other.first_point);
  }
}

TEST(Patches, AnotherSeedIsAnotherCut) {
  EXPECT_NE(Cut(testing::plate(), 50, 24, 1).patched.patches.elements.position,
            Cut(testing::plate(), 50, 24, 2).patched.patches.elements.position);
}

}  // namespace
}  // namespace luxel::matrix
