#include "luxel/solve/gather/rays/hit_store.h"

#include <gtest/gtest.h>

namespace luxel::gather {
namespace {

TEST(StoredHit, KeepsWhatIsPacked) {
  const uint32_t last = 16386u * 16386u - 1;  // of the largest atlas, with its border
  for (const uint32_t base : {0u, 1u, 12345678u, last})
    for (const uint32_t f : {0u, 7u, StoredHit::kSteps}) {
      const StoredHit hit =
          StoredHit::pack(base, f, StoredHit::kSteps - f,
                          {.tint = 1234, .second_half = f == 7, .doublings = f % 8});
      EXPECT_EQ(hit.base(), base);
      EXPECT_EQ(hit.fx(), f);
      EXPECT_EQ(hit.fy(), StoredHit::kSteps - f);
      EXPECT_EQ(hit.weight(), std::exp2(-float(f % 8)));
      EXPECT_EQ(hit.tint(), 1234u);
      EXPECT_EQ(hit.second_half(), f == 7);
    }
}

TEST(StoredHit, TintsAreRightInTheMean) {
  EXPECT_EQ(pack_tint({1, 1, 1}, 5), kNoTint);
  EXPECT_EQ(unpack_tint(kNoTint), (Rgb{1, 1, 1}));
  EXPECT_EQ(unpack_tint(pack_tint({0, 0, 0}, 5)), (Rgb{0, 0, 0}));
  const Rgb tint{0.9f, 0.517f, 0.02f};
  Rgb sum{};
  constexpr int kTints = 20000;
  for (uint64_t k = 0; k < kTints; ++k) sum += unpack_tint(pack_tint(tint, k));
  // A step of 1/7 by chance deviates by 1/14 at most: 5 standard errors of the mean are 0.0025.
  EXPECT_LE(length(sum / float(kTints) - tint), 0.0025f);
}

}  // namespace
}  // namespace luxel::gather
