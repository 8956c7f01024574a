// Results do not depend on the number of threads, and one thread reads what another updates.
#include "luxel/solve/matrix/relighter.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "luxel/base/parallel.h"
#include "luxel/solve/matrix/relighter_test_support.h"

namespace luxel::matrix {
namespace {

using testing::floor_places;
using testing::kAllCodecs;
using testing::kLeft;
using testing::kRight;
using testing::point_at;
using testing::relighter_of;
using testing::relit;
using testing::small;
using testing::Stage;

TEST(Relighter, SameBitsForAnyNumberOfThreads) {
  for (const CodecKind codec : kAllCodecs) {
    const RelightData data = Stage(scene::cornell_box(), small(codec)).data(floor_places(0.5f));
    const auto with = [&](int threads) {
      const ThreadLimit limit(threads);
      Relighter relighter = relighter_of(data, {true});
      return relit(relighter, {{&kLeft, 1}, {}, {1, 1, 1}});
    };
    const Relit one = with(1);
    for (const int threads : {2, 7}) {
      const Relit other = with(threads);
      EXPECT_EQ(one.direct, other.direct) << int(codec);
      EXPECT_EQ(one.indirect, other.indirect) << int(codec);
      EXPECT_EQ(one.direct_at_points, other.direct_at_points) << int(codec);
      EXPECT_EQ(one.indirect_at_points, other.indirect_at_points) << int(codec);
    }
  }
}

TEST(Relighter, AResultStaysUntilTheNextIsAskedFor) {
  Relighter relighter = relighter_of(Stage(scene::cornell_box()).data());
  EXPECT_EQ(relighter.latest().update, 0u);
  for (const Rgb& e : relighter.latest().indirect) EXPECT_EQ(e, Rgb{});
  relighter.update({{&kLeft, 1}});
  const Relit& held = relighter.latest();
  const Relit copy = held;
  EXPECT_EQ(copy.update, 1u);
  // As many updates as there are results to write to, and more.
  for (int k = 0; k < 5; ++k) {
    relighter.update({{&kRight, 1}});
    EXPECT_EQ(held.update, 1u);
    EXPECT_EQ(held.direct, copy.direct);
    EXPECT_EQ(held.indirect, copy.indirect);
  }
  const Relit& next = relighter.latest();
  EXPECT_EQ(next.update, 6u);
  EXPECT_NE(next.indirect, copy.indirect);
  EXPECT_EQ(&relighter.latest(), &next);  // nothing new since
}

/// Update k is lit by a lamp of 2^(k mod 8) times the first one's intensity. Powers of two scale
/// floats without rounding, so every number of a whole result is scaled exactly.
float scale_of(uint64_t update) { return std::ldexp(1.0f, int(update % 8)); }

bool is_scaled(const Relit& now, const Relit& base) {
  const float scale = scale_of(now.update);
  const auto same = [scale](std::span<const Rgb> a, std::span<const Rgb> b) {
    for (size_t i = 0; i < a.size(); ++i)
      if (!(a[i] == b[i] * scale)) return false;
    return a.size() == b.size();
  };
  return same(now.direct, base.direct) && same(now.indirect, base.indirect) &&
         same(now.indirect_at_points, base.indirect_at_points);
}

TEST(Relighter, OneThreadReadsWhatAnotherUpdates) {
  constexpr uint64_t kUpdates = 400;
  const Stage stage(scene::cornell_box(), small(CodecKind::hierarchical));
  Relighter relighter = relighter_of(stage.data(floor_places(0.5f)));
  const std::vector<Rgb> dark(relighter.data().material_name.size());
  const auto update = [&](uint64_t k) {
    const auto lamp = point_at(kLeft.position, kLeft.intensity * scale_of(k));
    relighter.update({{&lamp, 1}, dark});
  };
  update(1);
  Relit base = relighter.latest();
  for (auto* list : {&base.direct, &base.indirect, &base.indirect_at_points})
    for (Rgb& e : *list) e = e * (1 / scale_of(1));
  std::atomic<bool> reading{false};
  uint64_t last = 0, different = 0, torn = 0, back = 0;
  std::thread reader([&] {
    while (last < kUpdates) {
      const Relit& now = relighter.latest();
      torn += !is_scaled(now, base);
      back += now.update<last, different += now.update> last;
      last = now.update;
      reading = true;
    }
  });
  while (!reading) std::this_thread::yield();
  for (uint64_t k = 2; k <= kUpdates; ++k) update(k);
  reader.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(back, 0u);
  EXPECT_EQ(last, kUpdates);
  // Both ran at once: more than the first and the last update was seen.
  EXPECT_GT(different, 2u);
}

}  // namespace
}  // namespace luxel::matrix
