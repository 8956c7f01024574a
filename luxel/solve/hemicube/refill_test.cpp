// Light for elements that have none of their own.
#include "luxel/solve/hemicube/refill.h"

#include <gtest/gtest.h>

#include "luxel/solve/hemicube/receivers.h"

namespace luxel::hemicube {
namespace {

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
  refill(plan_refill(neighbours, hidden, std::vector<uint8_t>(hidden.size())), e);
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
  // Each of the two in the middle belongs to its side's ring: neither has the other's light.
  EXPECT_EQ(refilled(chain(4), {0, 1, 1, 0}, {6, 99, 99, 12}), (std::vector<float>{6, 6, 12, 12}));
  EXPECT_EQ(refilled(chain(3), {0, 1, 0}, {6, 99, 12}), (std::vector<float>{6, 9, 12}));
  EXPECT_EQ(refilled(chain(3), {0, 0, 0}, {6, 7, 12}), (std::vector<float>{6, 7, 12}));
}

TEST(Refill, LeavesOutWhatNoLightReaches) {
  Neighbours two = chain(4);  // cut between 1 and 2
  two.first = {0, 1, 2, 3, 4}, two.element = {1, 0, 3, 2};
  const RefillPlan plan =
      plan_refill(two, std::vector<uint8_t>{0, 1, 1, 1}, std::vector<uint8_t>(4));
  EXPECT_EQ(plan.element, (std::vector<uint32_t>{1}));
  EXPECT_EQ(refilled(two, {0, 1, 1, 1}, {6, 0, 0, 0}), (std::vector<float>{6, 6, 0, 0}));
  EXPECT_EQ(refilled(two, {1, 1, 1, 1}, {0, 0, 0, 0}), (std::vector<float>{0, 0, 0, 0}));
}

TEST(Refill, CoveredElementsAreRefilledAndBlackWhereNoLightReaches) {
  Neighbours two = chain(4);  // cut between 1 and 2
  two.first = {0, 1, 2, 3, 4}, two.element = {1, 0, 3, 2};
  std::vector<Rgb> e{{6, 6, 6}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  refill(plan_refill(two, std::vector<uint8_t>{0, 0, 0, 1}, std::vector<uint8_t>{0, 1, 1, 0}), e);
  EXPECT_EQ(e[1].x, 6);  // as its neighbour
  EXPECT_EQ(e[2].x, 0);  // covered, and so is nothing that has light
  EXPECT_EQ(e[3].x, 3);  // inside a solid: keeps what it has
}

}  // namespace
}  // namespace luxel::hemicube
