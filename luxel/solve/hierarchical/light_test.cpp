#include "luxel/solve/hierarchical/light.h"

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/solve/hierarchical/hierarchical_test_support.h"

namespace luxel::hierarchical {
namespace {

// The polynomial's largest error on [-1, 1] is that at 0: 3 / 32 = 0.094. Its mean over the sphere
// is that of the clamped cosine, 1 / 4; the grid's own error is its cells' squares.
TEST(Cosines, AreNearTheClampedCosine) {
  Cosines one;
  one.add({0, 0, 1}, {1, 2, 3});
  double mean = 0;
  constexpr int kSide = 128;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vec3 n = uniform_sphere_sample({(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide});
      const Rgb at = one.at(n);
      EXPECT_NEAR(at.x, std::max(0.0f, n.z), 0.094);
      EXPECT_NEAR(at.y, 2 * at.x, 1e-5);
      mean += double(at.x) / (kSide * kSide);
    }
  EXPECT_NEAR(mean, 0.25, 1e-4);
}

TEST(Cosines, SumUp) {
  Cosines a, b, both;
  RandomStream random{7};
  for (int k = 0; k < 20; ++k) {
    const Vec3 d = uniform_sphere_sample(random.next2());
    const Rgb v{random.next(), random.next(), random.next()};
    (k % 2 ? a : b).add(d, v), both.add(d, v);
  }
  a.add(b);
  const Vec3 n = normalize(Vec3{1, -2, 0.5f});
  EXPECT_NEAR(a.at(n).x, both.at(n).x, 1e-4);
  EXPECT_NEAR(a.at(n).z, both.at(n).z, 1e-4);
}

/// A square and a triangle, divided twice, and their bare light.
struct Two {
  Faces faces;
  Tree tree;
  Light light;

  Two() {
    for (const Polygon& p : {Polygon{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}},
                             Polygon{{0, 0, 1}, {0, 3, 1}, {1, 0, 1}}}) {
      Face face;
      face.corners = p, face.plane = viewfactor::plane_of(p);
      faces.faces.push_back(face);
    }
    tree = testing::tree_of(faces);
    for (const size_t e : {0, 1}) divide(tree, e);
    for (size_t e = 2; e < 6; ++e) divide(tree, e);
    divide(tree, 6), divide(tree, 9);
    light.clusters.resize(tree.clusters.size());
    light.elements.resize(tree.elements.size());
    for (ElementLight& l : light.elements) l.reflectance = {0.5f, 0.25f, 1};
  }
};

// Light that is linear over a root is so over all its parts, and the root's own linear function,
// put together from those of its parts, is the same.
TEST(PushPull, KeepsALinearFunction) {
  Two two;
  for (const size_t root : {0, 1})
    for (size_t k = 0; k < 4; ++k) {
      const float value = float(k == 0) + 3 * float(k == 1) + 2.5f * float(k == 2);
      two.light.elements[root].received[k] = {value, 2 * value, 1};
    }
  // On the rectangle linear means that opposite corners have the same sum.
  two.light.elements[0].received[3] = {0.5f, 1, 1};
  push_pull(two.faces, two.tree, two.light);
  for (const size_t root : {0, 1}) {
    const ElementLight& l = two.light.elements[root];
    for (size_t k = 0; k < two.tree.elements[root].corners; ++k) {
      EXPECT_NEAR(l.shining[k].x, 0.5f * l.received[k].x, 1e-5) << root << k;
      EXPECT_NEAR(l.shining[k].y, 0.25f * l.received[k].y, 1e-5);
      EXPECT_NEAR(l.shining[k].z, 1, 1e-5);
    }
    EXPECT_NEAR(l.rough, 0, 1e-5);
  }
  // A leaf's mean is the function at its middle.
  for (size_t e = 0; e < two.tree.elements.size(); ++e) {
    const Element& element = two.tree.elements[e];
    if (!element.is_leaf() || element.face != 0) continue;
    const double x = element.centre.x / 2, y = element.centre.y;
    EXPECT_NEAR(two.light.elements[e].irradiance.x, (1 + 2 * x) * (1 - y) + (0.5 + 2 * x) * y,
                1e-5);
  }
}

TEST(PushPull, KeepsPowerWhateverTheFunction) {
  Two two;
  RandomStream random{2};
  double sent = 0;
  for (size_t e = 0; e < two.tree.elements.size(); ++e) {
    const Element& element = two.tree.elements[e];
    for (uint32_t k = 0; k < element.corners; ++k) {
      const float v = random.next();
      two.light.elements[e].received[k] = {v, v, v};
      sent += element.area_m2 * double(v) / element.corners;
    }
    if (element.is_leaf()) two.light.elements[e].unlinked.fill({1, 1, 1}), sent += element.area_m2;
  }
  push_pull(two.faces, two.tree, two.light);
  double arrived = 0;
  for (const size_t root : {0, 1})
    arrived += two.tree.elements[root].area_m2 * double(two.light.elements[root].irradiance.x);
  EXPECT_NEAR(arrived, sent, 1e-5 * sent);
  EXPECT_GT(two.light.elements[0].rough, 0.01f);
}

// Links had brought 1 too much to a leaf, and bring only 0.4 now. No leaf sends less than nothing:
// rays are spread over what sources send, and light would not be a number.
TEST(PushPull, SendsNothingLessThanNothing) {
  Two two;
  for (ElementLight& l : two.light.elements) l.unlinked.fill({-1, 0.5f, -1});
  for (const size_t root : {0, 1}) two.light.elements[root].received.fill({0.4f, 0.4f, 3});
  push_pull(two.faces, two.tree, two.light);
  for (size_t e = 0; e < two.tree.elements.size(); ++e) {
    const ElementLight& l = two.light.elements[e];
    EXPECT_EQ(l.radiosity.x, 0) << e;
    EXPECT_NEAR(l.radiosity.y, 0.25 * 0.9, 1e-6);
    EXPECT_NEAR(l.radiosity.z, 2, 1e-6);
    if (two.tree.elements[e].is_leaf()) {
      EXPECT_EQ(l.shining[0].x, 0);
    }
  }
}

}  // namespace
}  // namespace luxel::hierarchical
