// Light that is handed on between elements: to those without any, and from fine to coarse ones.
#include "solve/hemicube/projection.h"

#include <gtest/gtest.h>

#include "solve/hemicube/hemicube_test_support.h"
#include "solve/hemicube/refill.h"

namespace luxel::hemicube {
namespace {

using testing::cut_at_random;
using testing::mesh_of;

/// A chain: each element is the neighbour of the ones before and after it.
Neighbours chain(uint32_t count) {
  Neighbours out;
  for (uint32_t i = 0; i < count; ++i) {
    out.first.push_back(uint32_t(out.element.size()));
    if (i > 0) out.element.push_back(i - 1);
    if (i + 1 < count) out.element.push_back(i + 1);
  }
  out.first.push_back(uint32_t(out.element.size()));
  return out;
}

std::vector<float> refilled(const Neighbours& neighbours, const std::vector<uint8_t>& hidden,
                            const std::vector<float>& light) {
  std::vector<Rgb> e;
  for (const float v : light) e.push_back({v, 2 * v, 0});
  refill(plan_refill(neighbours, hidden), e);
  std::vector<float> out;
  for (const Rgb& v : e) {
    EXPECT_EQ(v.y, 2 * v.x);
    out.push_back(v.x);
  }
  return out;
}

TEST(Refill, TakesTheMeanOfNeighboursRingByRing) {
  // 6 and 12 reach their next ones first; the middle one is their mean.
  EXPECT_EQ(refilled(chain(5), {0, 1, 1, 1, 0}, {6, 99, 99, 99, 12}),
            (std::vector<float>{6, 6, 9, 12, 12}));
  // Of two in the middle each belongs to its side's ring: neither has the other's light.
  EXPECT_EQ(refilled(chain(4), {0, 1, 1, 0}, {6, 99, 99, 12}), (std::vector<float>{6, 6, 12, 12}));
  EXPECT_EQ(refilled(chain(3), {0, 1, 0}, {6, 99, 12}), (std::vector<float>{6, 9, 12}));
  EXPECT_EQ(refilled(chain(3), {0, 0, 0}, {6, 7, 12}), (std::vector<float>{6, 7, 12}));
}

TEST(Refill, LeavesOutWhatNoLightReaches) {
  Neighbours two = chain(4);  // cut between 1 and 2
  two.first = {0, 1, 2, 3, 4}, two.element = {1, 0, 3, 2};
  const RefillPlan plan = plan_refill(two, std::vector<uint8_t>{0, 1, 1, 1});
  EXPECT_EQ(plan.element, (std::vector<uint32_t>{1}));
  EXPECT_EQ(refilled(two, {0, 1, 1, 1}, {6, 0, 0, 0}), (std::vector<float>{6, 6, 0, 0}));
  EXPECT_EQ(refilled(two, {1, 1, 1, 1}, {0, 0, 0, 0}), (std::vector<float>{0, 0, 0, 0}));
}

/// A coarse mesh, and a finer one cut from it.
struct Pair {
  scene::Scene scene;
  Mesh coarse, fine;
  Receivers sending, receiving;
};
Pair pair_of(ElementKind kind, int cuts) {
  Pair p;
  p.scene = scene::cornell_box();
  p.fine = p.coarse = mesh_of(p.scene, 0.15f);
  cut_at_random(p.fine, cuts, 7);
  p.sending = make_receivers(p.scene, p.coarse, kind);
  p.receiving = make_receivers(p.scene, p.fine, kind);
  return p;
}

std::vector<Rgb> random_light(size_t count, float least) {
  RandomStream random{3};
  std::vector<Rgb> out;
  for (size_t i = 0; i < count; ++i)
    out.push_back(Rgb{least, least, least} +
                  (1 - least) * Rgb{random.next(), random.next(), random.next()});
  return out;
}

/// The integral of linear (vertex) or constant (triangle) light over the mesh, triangle by
/// triangle: A times the mean of the corners.
double power(const Mesh& mesh, const Receivers& r, std::span<const Rgb> light) {
  double sum = 0;
  for (uint32_t i = 0; i < r.leaves.size(); ++i) {
    const Node& n = mesh.nodes[r.leaves[i]];
    const double area = double(scene::area_m2(
        {mesh.points[n.point[0]], mesh.points[n.point[1]], mesh.points[n.point[2]]}));
    const double mean =
        r.kind == ElementKind::triangle
            ? double(light[i].x)
            : double(light[n.vertex[0]].x + light[n.vertex[1]].x + light[n.vertex[2]].x) / 3;
    sum += area * mean;
  }
  return sum;
}

TEST(Projection, OfAMeshThatWasNotCutChangesNothing) {
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
    const Pair p = pair_of(kind, 0);
    const std::vector<Rgb> light = random_light(p.sending.size(), 0);
    EXPECT_EQ(sent(project(p.coarse, p.sending, p.fine, p.receiving), light), light);
  }
}

TEST(Projection, KeepsConstants) {
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle}) {
    const Pair p = pair_of(kind, 2000);
    ASSERT_GT(p.receiving.size(), p.sending.size() + 1000);
    const std::vector<Rgb> light(p.receiving.size(), Rgb{1, 2, 3});
    for (const Rgb& b : sent(project(p.coarse, p.sending, p.fine, p.receiving), light)) {
      EXPECT_NEAR(b.x, 1, 2e-5f);
      EXPECT_NEAR(b.z, 3, 6e-5f);
    }
  }
}

// Linear functions over a whole surface are what senders interpolate without loss. The floor is
// one.
TEST(Projection, KeepsLinearLight) {
  const Pair p = pair_of(ElementKind::vertex, 2000);
  const auto linear = [](const Receivers& r, const Mesh& mesh) {
    std::vector<Rgb> out;
    for (size_t v = 0; v < r.size(); ++v) {
      const Vec3 at = mesh.points[mesh.point_of[v]];
      out.push_back({1 + at.x + 2 * at.y + 3 * at.z, 1, 1});
    }
    return out;
  };
  const std::vector<Rgb> b =
      sent(project(p.coarse, p.sending, p.fine, p.receiving), linear(p.receiving, p.fine));
  const std::vector<Rgb> expected = linear(p.sending, p.coarse);
  for (size_t v = 0; v < b.size(); ++v) EXPECT_NEAR(b[v].x, expected[v].x, 1e-4f);
}

// Light of at least a half, so that no sender falls below nothing, where it is held.
TEST(Projection, SendsThePowerOfTheFineLight) {
  for (const ElementKind kind : {ElementKind::vertex, ElementKind::triangle})
    for (const int cuts : {1, 30, 3000}) {
      const Pair p = pair_of(kind, cuts);
      const std::vector<Rgb> light = random_light(p.receiving.size(), 0.5f);
      const std::vector<Rgb> b = sent(project(p.coarse, p.sending, p.fine, p.receiving), light);
      ASSERT_EQ(b.size(), p.sending.size());
      const double fine = power(p.fine, p.receiving, light);
      EXPECT_NEAR(power(p.coarse, p.sending, b), fine, 3e-6 * fine) << cuts;
    }
}

}  // namespace
}  // namespace luxel::hemicube
