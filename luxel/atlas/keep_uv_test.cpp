#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "luxel/atlas/atlas.h"
#include "luxel/atlas/atlas_test_support.h"
#include "luxel/atlas/keep_uv.h"
#include "luxel/atlas/shared_parts.h"

namespace luxel::atlas {
namespace {

using ::testing::HasSubstr;

/// Two quads side by side in the map, one metre apart in the world.
scene::Scene two_quads() {
  scene::Mesh mesh;
  mesh.name = "quads";
  testing::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  testing::add_quad(mesh, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0});
  mesh.uv1 = {{0, 0.5f}, {0.5f, 0.5f}, {0.5f, 0}, {0, 0},
              {0.5f, 1}, {1, 1},       {1, 0.5f}, {0.5f, 0.5f}};
  return testing::scene_of(std::move(mesh));
}

Result<Atlas> make(const scene::Scene& scene, UvMode uv) {
  AtlasParams params;
  params.uv = uv;
  params.resolution = 16;
  Progress progress;
  return make_atlas(scene, params, progress);
}

TEST(KeepUv, CornersAreTheFilesCoordinates) {
  const scene::Scene scene = two_quads();
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_TRUE(atlas) << atlas.error().message;
  EXPECT_EQ(atlas->corners[0], (std::array<Vec2, 3>{{{0, 8}, {8, 8}, {8, 0}}}));
  EXPECT_EQ(atlas->chart, (std::vector<uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(rasterise(scene, *atlas).texels.size(), 128u);
}

// Two charts meet at x = 8.25: the texels of column 8 belong to the second, which holds their
// centres, and a quarter of each is the first one's, by one of its triangles or by both.
TEST(KeepUv, FindsThePartsOfTexelsThatOtherChartsCover) {
  scene::Scene scene = two_quads();
  std::vector<Vec2>& uv = scene.meshes[0].uv1;
  for (size_t k = 4; k < 8; ++k) uv[k].y -= 0.5f;
  for (const size_t k : {1, 2, 4, 7}) uv[k].x = 8.25f / 16;
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_TRUE(atlas) << atlas.error().message;
  const TexelMap map = rasterise(scene, *atlas);
  std::vector<float> area(map.texels.size());
  for (const SharedPart& part : shared_parts(*atlas, map)) {
    area[part.texel] += part.area;
    EXPECT_LT(part.middle.triangle, 2u);
    const auto& c = atlas->corners[part.middle.triangle];
    const Vec2 at = interpolate(c[0], c[1], c[2], part.middle.at);
    EXPECT_GT(at.x, 8);
    EXPECT_LT(at.x, 8.25f);
    EXPECT_EQ(int(at.y), int(map.texels[part.texel].y));
  }
  for (size_t i = 0; i < area.size(); ++i)
    EXPECT_NEAR(area[i], map.texels[i].x == 8 ? 0.25f : 0, 1e-5f) << i;
}

TEST(KeepUv, NamesTheTrianglesThatOverlap) {
  scene::Scene scene = two_quads();
  for (int k = 4; k < 8; ++k) scene.meshes[0].uv1[k].x -= 0.25f, scene.meshes[0].uv1[k].y -= 0.25f;
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_FALSE(atlas);
  EXPECT_THAT(atlas.error().message, HasSubstr("in triangle 0 of mesh 'quads'"));
  EXPECT_THAT(atlas.error().message, HasSubstr("in triangle 3 of mesh 'quads'"));
}

TEST(KeepUv, NamesTheTriangleOutside) {
  scene::Scene scene = two_quads();
  scene.meshes[0].uv1[5].x = 1.5f;
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_FALSE(atlas);
  EXPECT_THAT(atlas.error().message,
              HasSubstr("triangle 2 of mesh 'quads' has TEXCOORD_1 (1.5, 1)"));
}

TEST(KeepUv, NotANumberIsOutside) {
  scene::Scene scene = two_quads();
  scene.meshes[0].uv1[5].x = NAN;
  EXPECT_FALSE(make(scene, UvMode::keep));
}

TEST(KeepUv, InstancesOfOneMeshShareAPlace) {
  scene::Scene scene = two_quads();
  scene.instances.push_back({"copy", 0, translation({0, 0, 5})});
  const Result<Atlas> atlas = make(scene, UvMode::keep);
  ASSERT_FALSE(atlas);
  EXPECT_THAT(atlas.error().message, HasSubstr("share mesh 'quads'"));
  EXPECT_THAT(atlas.error().message, HasSubstr("--uv unwrap"));
}

TEST(KeepUv, AutomaticKeepsWhatIsValidAndUnwrapsTheRest) {
  scene::Scene scene = two_quads();
  const Result<Atlas> kept = make(scene, UvMode::automatic);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->corners[0][1], (Vec2{8, 8}));
  scene.meshes[0].uv1.clear();
  EXPECT_FALSE(make(scene, UvMode::keep));
  const Result<Atlas> unwrapped = make(scene, UvMode::automatic);
  ASSERT_TRUE(unwrapped);
  EXPECT_EQ(unwrapped->chart_count, 2u);
}

/// The reason of automatic not to keep a TEXCOORD_1 that can be drawn; empty: it is kept.
std::string why_replaced(const scene::Scene& scene) {
  Progress progress;
  const Result<Atlas> kept = make(scene, UvMode::keep);
  EXPECT_TRUE(kept) << kept.error().message;
  const Result<std::string> why = why_no_layout(scene, *kept, progress);
  EXPECT_EQ(make(scene, UvMode::automatic)->kept, why->empty());
  return *why;
}

/// A square beside the two, which have 2 m^2.
scene::Scene with_third_quad(float side, std::array<Vec2, 4> uv1) {
  scene::Scene scene = two_quads();
  testing::add_quad(scene.meshes[0], {0, 0, 9}, {side, 0, 9}, {side, side, 9}, {0, side, 9});
  scene.meshes[0].uv1.insert(scene.meshes[0].uv1.end(), uv1.begin(), uv1.end());
  scene.meshes[0].triangle_material.resize(6);
  return scene;
}

// An object that was never unwrapped there: all zeros, one line, or what rounding makes of them.
TEST(KeepUv, AutomaticReplacesWhatIsAPointOrALine) {
  const Vec2 a{0.1f, 0.1f}, b{0.4f, 0.2f}, e{1e-4f, 0}, f{0, 1e-4f};
  EXPECT_EQ(why_replaced(two_quads()), "");
  for (const auto& uv1 :
       {std::array{a, a, a, a}, std::array{a, b, a, b}, std::array{a, a + e, a + e + f, a + f},
        std::array{a, b, b + f * 1e-3f, a + f * 1e-3f}})
    EXPECT_THAT(why_replaced(with_third_quad(1, uv1)),
                HasSubstr("2 triangles of 'one' (mesh 'quads')"));
}

// Where all is a line up to rounding there is no other scale to hold it against.
TEST(KeepUv, AutomaticReplacesALayoutOfLines) {
  scene::Scene scene = two_quads();
  for (Vec2& uv : scene.meshes[0].uv1) uv.y = 0.3f + 1e-7f * uv.y;
  EXPECT_THAT(why_replaced(scene), HasSubstr("4 triangles of 'one'"));
}

TEST(KeepUv, ASliverOfTheAreaMayBeAPoint) {
  const std::array<Vec2, 4> point{};
  EXPECT_EQ(why_replaced(with_third_quad(0.1f, point)), "");   // 0.5 % of the area
  EXPECT_NE(why_replaced(with_third_quad(0.16f, point)), "");  // 1.3 %
}

/// Quads of 1 m in a row, `apart` from each other, each an eighth of a texel wide.
scene::Scene row_of_small_charts(int count, float apart) {
  scene::Mesh mesh;
  mesh.name = "row";
  constexpr float kTexel = 1.0f / 16, kSide = kTexel / 8;
  for (int k = 0; k < count; ++k) {
    const float x = float(k) * (1 + apart);
    testing::add_quad(mesh, {x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0});
    // Charts in blocks of eight to a side fill a texel each.
    const Vec2 at = apart > 0 ? Vec2{float(k % 8), float(k / 8)} * kSide + Vec2{kTexel, kTexel}
                              : Vec2{float(k) * kSide, 0.3f};
    for (const Vec2 d : {Vec2{0, 0}, Vec2{kSide, 0}, Vec2{kSide, kSide}, Vec2{0, kSide}})
      mesh.uv1.push_back(at + d);
  }
  return testing::scene_of(std::move(mesh));
}

// None of them holds the centre of a texel, so none overlaps another there.
TEST(KeepUv, AutomaticReplacesATexelOfMuchThatLiesApart) {
  EXPECT_THAT(why_replaced(row_of_small_charts(64, 1)), HasSubstr("that also hold what lies far"));
}

TEST(KeepUv, AutomaticKeepsTexelsOfWhatHangsTogether) {
  EXPECT_EQ(why_replaced(row_of_small_charts(64, 0)), "");
}

}  // namespace
}  // namespace luxel::atlas
