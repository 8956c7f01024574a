#include "luxel/base/vec.h"

#include <gtest/gtest.h>

#include "luxel/base/random.h"

namespace luxel {
namespace {

Vec3 random_vector(RandomStream& random) {
  return {2 * random.next() - 1, 2 * random.next() - 1, 2 * random.next() - 1};
}

Mat34 random_map(RandomStream& random) {
  return from_columns(random_vector(random), random_vector(random), random_vector(random),
                      random_vector(random));
}

void expect_near(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_LT(length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Vec, ProductsObeyTheirLaws) {
  RandomStream random{1};
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = random_vector(random), b = random_vector(random), c = random_vector(random);
    EXPECT_NEAR(dot(cross(a, b), a), 0, 1e-6);
    EXPECT_NEAR(dot(cross(a, b), b), 0, 1e-6);
    EXPECT_NEAR(dot(cross(a, b), c), dot(cross(b, c), a), 1e-6);
    // Lagrange: |a x b|^2 + (a . b)^2 = |a|^2 |b|^2
    EXPECT_NEAR(dot(cross(a, b), cross(a, b)) + dot(a, b) * dot(a, b), dot(a, a) * dot(b, b), 1e-5);
    EXPECT_NEAR(length(normalize(a)), 1, 1e-6);
  }
  EXPECT_EQ(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(normalize(Vec3{}), Vec3{});
  EXPECT_GT(cross(Vec2{1, 0}, Vec2{0, 1}), 0);
}

TEST(Vec, FiniteMeansAllThree) {
  EXPECT_TRUE(is_finite(Vec3{1, 2, 3}));
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    EXPECT_FALSE(is_finite(Vec3{bad, 0, 0}));
    EXPECT_FALSE(is_finite(Vec3{0, bad, 0}));
    EXPECT_FALSE(is_finite(Vec3{0, 0, bad}));
  }
}

TEST(Interpolate, GivesTheCornersAndTheMiddle) {
  const Vec3 a{1, 2, 3}, b{4, 6, 8}, c{-1, 0, 5};
  EXPECT_EQ(interpolate(a, b, c, {0, 0}), a);
  EXPECT_EQ(interpolate(a, b, c, {1, 0}), b);
  EXPECT_EQ(interpolate(a, b, c, {0, 1}), c);
  expect_near(interpolate(a, b, c, {1 / 3.f, 1 / 3.f}), (a + b + c) / 3, 1e-6f);
}

TEST(FrameAround, IsOrthonormalAndRightHandedForEveryNormal) {
  RandomStream random{2};
  std::vector<Vec3> normals{{0, 0, 1},
                            {0, 0, -1},
                            {1, 0, 0},
                            {-1, 0, 0},
                            {0, 1, 0},
                            {0, -1, 0},
                            {1, 0, -0.0f},
                            {0, 1, -0.0f},
                            normalize(Vec3{1e-4f, -1e-4f, -1}),
                            normalize(Vec3{1e-7f, 0, -1})};
  while (normals.size() < 10000) normals.push_back(normalize(random_vector(random)));
  for (const Vec3& n : normals) {
    const Frame f = frame_around(n);
    EXPECT_EQ(f.normal, n);
    EXPECT_NEAR(length(f.tangent), 1, 2e-6);
    EXPECT_NEAR(length(f.bitangent), 1, 2e-6);
    EXPECT_NEAR(dot(f.tangent, n), 0, 2e-6);
    EXPECT_NEAR(dot(f.bitangent, n), 0, 2e-6);
    expect_near(cross(f.tangent, f.bitangent), n, 4e-6f);
    expect_near(f.to_world({0, 0, 2}), n * 2, 1e-6f);
  }
}

TEST(Mat34, ProductIsOneMapAfterTheOther) {
  RandomStream random{3};
  for (int i = 0; i < 1000; ++i) {
    const Mat34 a = random_map(random), b = random_map(random);
    const Vec3 p = random_vector(random);
    expect_near(transform_point(a * b, p), transform_point(a, transform_point(b, p)), 1e-5f);
    expect_near(transform_vector(a * b, p), transform_vector(a, transform_vector(b, p)), 1e-5f);
    EXPECT_NEAR(determinant(a * b), determinant(a) * determinant(b), 1e-5);
    EXPECT_EQ(a * Mat34{}, a);
    EXPECT_EQ(Mat34{} * a, a);
  }
}

TEST(Mat34, PiecesDoWhatTheySay) {
  expect_near(transform_point(translation({1, 2, 3}), {1, 1, 1}), {2, 3, 4}, 1e-6f);
  expect_near(transform_vector(translation({1, 2, 3}), {1, 1, 1}), {1, 1, 1}, 1e-6f);
  expect_near(transform_point(scaling({2, -1, 0.5f}), {1, 1, 1}), {2, -1, 0.5f}, 1e-6f);
  const Mat34 m = from_columns({1, 2, 3}, {4, 5, 6}, {7, 8, 10}, {-1, -2, -3});
  EXPECT_EQ(column(m, 1), (Vec3{4, 5, 6}));
  expect_near(transform_point(m, {0, 1, 0}), {3, 3, 3}, 1e-6f);
  EXPECT_NEAR(determinant(m), -3, 1e-5);  // by the rule of Sarrus
  EXPECT_NEAR(determinant(scaling({-1, 1, 1})), -1, 1e-6);
}

// The plane through a with normal n is the set n . (x - a) = 0. Its image under m has the mapped
// edge vectors as tangents, so the mapped normal is at right angles to both, and the image of a
// point on the front side lies on the front side.
TEST(TransformNormal, FollowsThePlaneAndItsFrontSide) {
  RandomStream random{4};
  int mirrored = 0;
  for (int i = 0; i < 1000; ++i) {
    const Mat34 m = random_map(random);
    if (std::abs(determinant(m)) < 0.01f) continue;
    mirrored += determinant(m) < 0;
    const Vec3 n = normalize(random_vector(random));
    const Frame f = frame_around(n);
    const Vec3 image = normalize(transform_normal(m, n));
    EXPECT_NEAR(length(image), 1, 1e-5);
    EXPECT_NEAR(dot(image, normalize(transform_vector(m, f.tangent))), 0, 1e-4);
    EXPECT_NEAR(dot(image, normalize(transform_vector(m, f.bitangent))), 0, 1e-4);
    EXPECT_GT(dot(image, transform_vector(m, n)), 0);
  }
  EXPECT_GT(mirrored, 100);
}

TEST(Box3, GrowsByPoints) {
  Box3 box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.diagonal(), 0);
  box.extend({1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.centre(), (Vec3{1, 2, 3}));
  box.extend({-1, 4, 4});
  EXPECT_EQ(box.lower, (Vec3{-1, 2, 3}));
  EXPECT_EQ(box.upper, (Vec3{1, 4, 4}));
  EXPECT_EQ(box.diagonal(), 3);  // sqrt(4 + 4 + 1)
}

}  // namespace
}  // namespace luxel
