#include "luxel/scene/scene.h"

#include <gtest/gtest.h>

#include "luxel/image/color.h"

namespace luxel::scene {
namespace {

void expect_vec_near(Vec3 a, Vec3 b, float tolerance = 1e-6f) {
  EXPECT_LT(length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

/// One triangle with its front towards +z, uv = (x, y).
Scene one_triangle(const Mat34& world_from_object = {}) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uv0 = {{0, 0}, {1, 0}, {0, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.triangle_material = {0};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"", 0, world_from_object});
  scene.materials.push_back({});
  return scene;
}

/// The barycentrics of uv on that triangle are uv itself.
SurfacePoint at_uv(float u, float v) { return {0, 0, {u, v}}; }

TEST(WorldTriangle, KeepsTheOrderOfTheCorners) {
  const Mat34 m = translation({1, 2, 3}) * scaling({2, -3, 4});
  const Scene scene = one_triangle(m);
  const Triangle3 t = world_triangle(scene, 0, 0);
  expect_vec_near(t.a, {1, 2, 3});
  expect_vec_near(t.b, {3, 2, 3});
  expect_vec_near(t.c, {1, -1, 3});
  expect_vec_near(world_position(scene, at_uv(0.25f, 0.5f)), {1.5f, 0.5f, 3});
}

// glTF: the front side of a mirrored instance is the image of its front side. Scaling x or y by -1
// leaves the triangle's plane and its front towards +z; scaling z turns the front towards -z.
TEST(FrontNormal, IsTheImageOfTheFrontSideUnderMirroring) {
  const auto normal = [](Vec3 s) { return front_normal(one_triangle(scaling(s)), 0, 0); };
  expect_vec_near(normal({1, 1, 1}), {0, 0, 1});
  expect_vec_near(normal({-1, 1, 1}), {0, 0, 1});
  expect_vec_near(normal({1, -2, 1}), {0, 0, 1});
  expect_vec_near(normal({1, 1, -3}), {0, 0, -1});
  expect_vec_near(normal({-1, -1, -1}), {0, 0, -1});
  expect_vec_near(normal({1, 0, 1}), {0, 0, 0});
}

// A plane z = x with its true normal (-1, 0, 1), stretched by 2 along x: z = x / 2, (-1, 0, 2).
TEST(ShadingNormal, FollowsTheSurfaceUnderNonUniformScaleAndMirroring) {
  for (const float side : {1.0f, -1.0f}) {
    Scene scene = one_triangle(scaling({2 * side, 1, 1}));
    scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 1}, {0, 1, 0}};
    scene.meshes[0].normals.assign(3, normalize(Vec3{-1, 0, 1}));
    expect_vec_near(shading_normal(scene, at_uv(.3f, .3f)), normalize(Vec3{-side, 0, 2}));
    expect_vec_near(front_normal(scene, 0, 0), normalize(Vec3{-side, 0, 2}));
  }
}

TEST(ShadingNormal, InterpolatesAndStaysOnTheFrontSide) {
  Scene scene = one_triangle();
  scene.meshes[0].normals = {normalize(Vec3{0.3f, 0, 1}), {0, 0, 1}, {0, 0, 1}};
  expect_vec_near(shading_normal(scene, at_uv(0, 0)), normalize(Vec3{0.3f, 0, 1}));
  const Vec3 half = normalize(scene.meshes[0].normals[0] + Vec3{0, 0, 1});
  expect_vec_near(shading_normal(scene, at_uv(0.5f, 0)), half);
  // Files with normals turned inwards.
  for (Vec3& n : scene.meshes[0].normals) n = -n;
  expect_vec_near(shading_normal(scene, at_uv(0.5f, 0)), half);
  // Normals that cancel out, or lie in the surface.
  scene.meshes[0].normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}};
  expect_vec_near(shading_normal(scene, at_uv(0.5f, 0)), {0, 0, 1});
  expect_vec_near(shading_normal(scene, at_uv(0, 1)), {0, 0, 1});
  scene.meshes[0].normals.clear();
  expect_vec_near(shading_normal(scene, at_uv(0.1f, 0.2f)), {0, 0, 1});
}

/// 4 x 2 texels whose red is the texel's number times 20, green 255 - red, blue 0, alpha 128 + x.
Texture numbered_texture() {
  Texture t;
  t.width = 4, t.height = 2;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      const int red = 20 * (4 * y + x);
      for (const int v : {red, 255 - red, 0, 128 + x}) t.rgba.push_back(uint8_t(v));
    }
  return t;
}

Scene textured(const TextureRef& ref) {
  Scene scene = one_triangle();
  scene.textures.push_back(numbered_texture());
  scene.materials[0].base_color_texture = ref;
  scene.materials[0].base_color_texture.texture = 0;
  return scene;
}

float linear_red(int x, int y) { return image::linear_from_srgb(float(20 * (4 * y + x)) / 255.0f); }
float red_at(const Scene& scene, float u, float v) { return base_color_at(scene, at_uv(u, v))[0]; }

TEST(TextureLookup, IsExactAtTexelCentres) {
  const Scene scene = textured({});
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) {
      const auto c = base_color_at(scene, at_uv((float(x) + 0.5f) / 4, (float(y) + 0.5f) / 2));
      EXPECT_NEAR(c[0], linear_red(x, y), 1e-6);
      EXPECT_NEAR(c[1], image::linear_from_srgb(float(255 - 20 * (4 * y + x)) / 255), 1e-6);
      EXPECT_EQ(c[2], 0);
      EXPECT_NEAR(c[3], float(128 + x) / 255, 1e-6);  // alpha is not a colour: no sRGB curve
    }
}

TEST(TextureLookup, InterpolatesInLinearLight) {
  const Scene scene = textured({});
  const float quarter_way = 0.75f * linear_red(1, 0) + 0.25f * linear_red(2, 0);
  EXPECT_NEAR(red_at(scene, 1.75f / 4, 0.25f), quarter_way, 1e-6);
  const float corner =
      (linear_red(1, 0) + linear_red(2, 0) + linear_red(1, 1) + linear_red(2, 1)) / 4;
  EXPECT_NEAR(red_at(scene, 0.5f, 0.5f), corner, 1e-6);
}

// Outside [0, 1], told by what the three modes mean: repeat goes on with texel 0 after 3, clamp
// stays on 3, mirror comes back 3, 2, 1. At u = 1 bilinear takes the mean of both sides of the
// edge.
TEST(TextureLookup, Wraps) {
  const auto wrapped = [](Wrap wrap, float texels_u) {
    TextureRef ref;
    ref.wrap_u = wrap;
    ref.scale = {8, 1}, ref.offset = {-4, 0};
    return red_at(textured(ref), (texels_u / 4 + 4) / 8, 0.25f);
  };
  const float e = 3e-6f;
  EXPECT_NEAR(wrapped(Wrap::repeat, 4.5f), linear_red(0, 0), e);
  EXPECT_NEAR(wrapped(Wrap::repeat, -0.5f), linear_red(3, 0), e);
  EXPECT_NEAR(wrapped(Wrap::repeat, -10.5f), linear_red(1, 0), e);
  EXPECT_NEAR(wrapped(Wrap::repeat, 4), 0.5f * (linear_red(3, 0) + linear_red(0, 0)), e);
  EXPECT_NEAR(wrapped(Wrap::clamp, 4.5f), linear_red(3, 0), e);
  EXPECT_NEAR(wrapped(Wrap::clamp, -7.5f), linear_red(0, 0), e);
  EXPECT_NEAR(wrapped(Wrap::mirror, 4.5f), linear_red(3, 0), e);
  EXPECT_NEAR(wrapped(Wrap::mirror, 6.5f), linear_red(1, 0), e);
  EXPECT_NEAR(wrapped(Wrap::mirror, 8.5f), linear_red(0, 0), e);
  EXPECT_NEAR(wrapped(Wrap::mirror, -0.5f), linear_red(0, 0), e);
  EXPECT_NEAR(wrapped(Wrap::mirror, -2.5f), linear_red(2, 0), e);
}

TEST(TextureLookup, NearestTakesTheTexelUnderThePoint) {
  TextureRef ref;
  ref.filter = Filter::nearest;
  const Scene scene = textured(ref);
  EXPECT_NEAR(red_at(scene, 0.26f, 0.1f), linear_red(1, 0), 1e-6);
  EXPECT_NEAR(red_at(scene, 0.49f, 0.1f), linear_red(1, 0), 1e-6);
  EXPECT_NEAR(red_at(scene, 0.3f, 0.6f), linear_red(1, 1), 1e-6);
}

// KHR_texture_transform multiplies translation * rotation * scale with the matrix
// [cos sin; -sin cos] acting on (u, v). By hand, for rotation 90 degrees (u, v) -> (v, -u), scale
// (0.5, 2) before and offset (0.25, 1) after: (0.25, 0.125) -> (0.125, 0.25) -> (0.25, -0.125)
// -> (0.5, 0.875), which is the corner of texels 1 and 2 in row 1.
TEST(TextureLookup, AppliesTheTextureTransformInTheOrderOfTheExtension) {
  TextureRef ref;
  ref.scale = {0.5f, 2};
  ref.rotation = kPi / 2;
  ref.offset = {0.25f, 1};
  ref.wrap_v = Wrap::clamp;
  EXPECT_NEAR(red_at(textured(ref), 0.25f, 0.125f), 0.5f * (linear_red(1, 1) + linear_red(2, 1)),
              1e-5);
}

TEST(TextureLookup, SurvivesCoordinatesOutOfAllBounds) {
  TextureRef ref;
  ref.scale = {3e38f, -INFINITY};
  const float red = red_at(textured(ref), 0.3f, 0.3f);
  EXPECT_TRUE(red >= 0 && red <= 1) << red;
}

TEST(TextureLookup, UsesTheUvSetOfTheReference) {
  TextureRef ref;
  ref.uv_set = 1;
  Scene scene = textured(ref);
  EXPECT_EQ(red_at(scene, 0.1f, 0.1f), 1) << "white without that set";
  scene.meshes[0].uv1.assign(3, {0.625f, 0.75f});
  EXPECT_NEAR(red_at(scene, 0.1f, 0.1f), linear_red(2, 1), 1e-6);
}

TEST(BaseColor, MultipliesFactorTextureAndVertexColour) {
  Scene scene = textured({});
  scene.materials[0].base_color = {0.5f, 1, 1};
  scene.materials[0].alpha = 0.5f;
  scene.meshes[0].colors = {{0, 1, 1}, {1, 1, 1}, {0, 1, 1}};  // red grows along u
  const auto c = base_color_at(scene, at_uv(0.625f, 0.25f));
  EXPECT_NEAR(c[0], 0.5f * 0.625f * linear_red(2, 0), 1e-6);
  EXPECT_NEAR(c[3], 0.5f * 130 / 255, 1e-6);
}

// A ramp of alpha, (0, 1, 0) at the corners, times the material's 0.8.
TEST(BaseColor, VertexAlphaMultipliesAlpha) {
  Scene scene = one_triangle();
  Material& m = scene.materials[0];
  scene.meshes[0].alphas = {0, 1, 0};
  m.alpha = 0.8f;
  EXPECT_NEAR(base_color_at(scene, at_uv(0.625f, 0.25f))[3], 0.8f * 0.625f, 1e-6);
  EXPECT_EQ(passage_at(scene, at_uv(0.625f, 0.25f)).coverage, 1) << "opaque: alpha is not asked";
  m.alpha_mode = AlphaMode::blend, m.base_color = {0, 0, 0};
  const Passage passage = passage_at(scene, at_uv(0.625f, 0.25f));
  EXPECT_NEAR(passage.coverage, 0.5f, 1e-6);
  EXPECT_NEAR(passage.tint.x, 0.5f, 1e-6);
  m.alpha_mode = AlphaMode::mask, m.alpha_cutoff = 0.4f;  // where the ramp is below 0.5
  EXPECT_FALSE(is_solid_at(scene, at_uv(0.49f, 0.1f)));
  EXPECT_EQ(passage_at(scene, at_uv(0.49f, 0.1f)).coverage, 0);
  EXPECT_TRUE(is_solid_at(scene, at_uv(0.51f, 0.1f)));
  EXPECT_EQ(passage_at(scene, at_uv(0.51f, 0.1f)).coverage, 1);
}

TEST(BaseColor, EqualAlphasAreNotRounded) {
  Scene scene = one_triangle();
  scene.materials[0].alpha_mode = AlphaMode::mask, scene.materials[0].alpha_cutoff = 1;
  scene.meshes[0].alphas = {1, 1, 1};
  for (int i = 0; i < 50; ++i)
    for (int j = 0; i + j < 50; ++j)
      EXPECT_TRUE(is_solid_at(scene, at_uv(float(i) / 49, float(j) / 49))) << i << " " << j;
}

TEST(Reflectance, IsTheDiffusePartClampedTo099) {
  Scene scene = one_triangle();
  Material& m = scene.materials[0];
  m.base_color = {0.8f, 1, -1};
  expect_vec_near(reflectance_at(scene, {}), {0.8f, 0.99f, 0});
  m.metallic = 0.25f;
  expect_vec_near(reflectance_at(scene, {}), {0.6f, 0.75f, 0});
  m.metallic = 1;
  expect_vec_near(reflectance_at(scene, {}), {0, 0, 0});
  // The metallic texture counts in its blue channel, which is linear; here it is 0.
  scene.textures.push_back(numbered_texture());
  m.metallic_texture.texture = 0;
  expect_vec_near(reflectance_at(scene, {}), {0.8f, 0.99f, 0});
}

TEST(Emission, IsTintedByItsTexture) {
  Scene scene = one_triangle();
  scene.textures.push_back(numbered_texture());
  scene.materials[0].emission = {10, 0, 0};
  expect_vec_near(emission_at(scene, at_uv(0.625f, 0.25f)), {10, 0, 0});
  scene.materials[0].emission_texture.texture = 0;
  expect_vec_near(emission_at(scene, at_uv(0.625f, 0.25f)), {10 * linear_red(2, 0), 0, 0});
}

TEST(AlphaMask, CutsHolesOnlyInMaskMode) {
  Scene scene = textured({});
  Material& m = scene.materials[0];
  m.alpha_cutoff = 130.0f / 255 - 1e-4f;  // alpha is (128 + x) / 255
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend, AlphaMode::mask}) {
    m.alpha_mode = mode;
    EXPECT_TRUE(is_solid_at(scene, at_uv(0.625f, 0.25f)));
    EXPECT_EQ(is_solid_at(scene, at_uv(0.125f, 0.25f)), mode != AlphaMode::mask);
  }
}

TEST(FirstTriangles, NumbersTheTrianglesOfAllInstances) {
  Scene scene = one_triangle();
  Mesh two = scene.meshes[0];
  two.triangles.push_back({0, 2, 1});
  two.triangle_material.push_back(0);
  scene.meshes.push_back(two);
  scene.instances = {{"", 1, {}}, {"", 0, {}}, {"", 1, {}}};
  EXPECT_EQ(first_triangles(scene), (std::vector<uint32_t>{0, 2, 3, 5}));
  EXPECT_EQ(first_triangles({}), (std::vector<uint32_t>{0}));
}

TEST(WorldBounds, HoldsAllInstances) {
  Scene scene = one_triangle();
  EXPECT_TRUE(world_bounds({}).empty());
  scene.instances.push_back({"", 0, translation({5, 5, 5}) * scaling({-1, 2, 1})});
  const Box3 box = world_bounds(scene);
  expect_vec_near(box.lower, {0, 0, 0});
  expect_vec_near(box.upper, {5, 7, 5});
}

}  // namespace
}  // namespace luxel::scene
