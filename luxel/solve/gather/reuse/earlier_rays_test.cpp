#include "luxel/solve/gather/reuse/earlier_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>
#include <numeric>
#include <vector>

#include "luxel/base/bytes.h"
#include "luxel/base/random.h"
#include "luxel/solve/gather/gather_test_support.h"

namespace luxel::gather {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

/// True: the half-line meets the box with `margin` on all sides, which may be less than 0.
bool meets_exactly(const Box3& box, const trace::Ray& ray, double margin) {
  double begin = 0, end = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const double from = double(ray.origin[axis]), d = double(ray.direction[axis]);
    const double lower = double(box.lower[axis]) - margin - from;
    const double upper = double(box.upper[axis]) + margin - from;
    if (lower > upper) return false;
    if (d == 0) {
      if (lower > 0 || upper < 0) return false;
      continue;
    }
    begin = std::max(begin, std::min(lower / d, upper / d));
    end = std::min(end, std::max(lower / d, upper / d));
  }
  return begin <= end;
}

Vec3 point_between(RandomStream& random, const Box3& box) {
  const Vec3 at{random.next(), random.next(), random.next()};
  return box.lower + (box.upper - box.lower) * at;
}

/// Boxes of all sizes, also flat ones, and places inside of them, near and far away.
struct Look {
  Box3 box;
  Vec3 from;
  float far = 0;  ///< the farthest point of the box
};
Look random_look(RandomStream& random) {
  Look out;
  const auto power = [&](float lowest, float highest) {
    return std::pow(10.0f, lowest + (highest - lowest) * random.next());
  };
  const Vec3 centre = Vec3{random.next(), random.next(), random.next()} * 20.0f;
  Vec3 half{power(-2, 1), power(-2, 1), power(-2, 1)};
  if (random.next() < 0.2f) half.y = 0;
  out.box = {centre - half, centre + half};
  const Vec3 away =
      normalize(Vec3{random.next(), random.next(), random.next()} - Vec3{.5f, .5f, .5f});
  out.from = random.next() < 0.2f ? point_between(random, out.box) : centre + away * power(-1, 3);
  out.far = length(out.from - centre) + length(half);
  return out;
}

/// Towards points of the box, past its edges, and anywhere.
std::vector<trace::Ray> random_rays(RandomStream& random, const Look& look) {
  std::vector<trace::Ray> rays;
  const auto add = [&](Vec3 to) { rays.push_back({look.from, 0, normalize(to), INFINITY}); };
  Box3 wide = look.box;
  const float by = 0.5f * look.box.diagonal();
  wide.lower = wide.lower - Vec3{by, by, by}, wide.upper = wide.upper + Vec3{by, by, by};
  for (int k = 0; k < 40; ++k) {
    add(point_between(random, look.box) - look.from);
    add(point_between(random, wide) - look.from);
    add(Vec3{random.next(), random.next(), random.next()} - Vec3{0.5f, 0.5f, 0.5f});
  }
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}}) add(axis);
  return rays;
}

void mark_all(std::span<const Box3> boxes, std::span<const trace::Ray> rays,
              std::span<uint8_t> again) {
  std::vector<uint32_t> all(rays.size());
  std::iota(all.begin(), all.end(), 0u);
  mark_rays(boxes, rays, all, again);
}

// A direction's rounding moves the ray's end by 1e-7 of the way at each of a few steps, and so do
// the box's coordinates: 2e-6 of the farthest coordinates is beyond all of it.
TEST(MarkRays, MeetTheBoxAsInExactArithmetic) {
  RandomStream random{11};
  size_t inside = 0, met = 0, missed = 0, unsure = 0;
  for (int k = 0; k < 3000; ++k) {
    const Look look = random_look(random);
    const std::vector<trace::Ray> rays = random_rays(random, look);
    std::vector<uint8_t> again(rays.size(), 0);
    mark_all(std::span(&look.box, 1), rays, again);
    const double margin = 2e-6 * (double(look.far) + 50);
    inside += meets_exactly(look.box, {look.from, 0, {0, 0, 0}, 0}, 0);
    for (size_t r = 0; r < rays.size(); ++r) {
      const bool surely = meets_exactly(look.box, rays[r], -margin);
      const bool maybe = meets_exactly(look.box, rays[r], margin);
      if (surely) {
        EXPECT_TRUE(again[r]) << "missed, from " << look.far << " m away";
      }
      if (!maybe) {
        EXPECT_FALSE(again[r]) << "marked, from " << look.far << " m away";
      }
      ++(surely ? met : maybe ? unsure : missed);
    }
  }
  EXPECT_GT(inside, 100u);
  EXPECT_GT(met, 50000u);
  EXPECT_GT(missed, 50000u);
  EXPECT_LT(unsure, met);  // the flat boxes, which a ray meets in one point, and edges
}

// A plate is met in a point: the two ends of the way through it are the same number.
TEST(MarkRays, MeetPlatesThroughTheirMiddle) {
  RandomStream random{12};
  const Box3 plate{{-1, 0.3f, -1}, {1, 0.3f, 1}};
  std::vector<trace::Ray> rays;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 to{1.9f * random.next() - 0.95f, 0.3f, 1.9f * random.next() - 0.95f};
    rays.push_back({{0, 2, 0}, 0, normalize(to - Vec3{0, 2, 0}), INFINITY});
  }
  std::vector<uint8_t> again(rays.size(), 0);
  mark_all(std::span(&plate, 1), rays, again);
  EXPECT_EQ(std::ranges::count(again, 1), 1000);
  for (trace::Ray& ray : rays) ray.direction = -ray.direction;
  std::ranges::fill(again, uint8_t(0));
  mark_all(std::span(&plate, 1), rays, again);
  EXPECT_EQ(std::ranges::count(again, 1), 0) << "it lies behind";
}

TEST(MarkRays, LooksOnlyAtThoseThatAreAskedFor) {
  const Box3 box{{1, -1, -1}, {2, 1, 1}};
  const std::vector<trace::Ray> rays(3, {{0, 0, 0}, 0, {1, 0, 0}, INFINITY});
  std::vector<uint8_t> again(3, 0);
  mark_rays(std::span(&box, 1), rays, std::vector<uint32_t>{0, 2}, again);
  EXPECT_EQ(again, (std::vector<uint8_t>{1, 0, 1}));
}

/// An element that looks at a box, and its rays.
struct Watched {
  Look look;
  Vec3 normal, geometric;
  RayBatch batch;
};
/// `bent`: how far its normal is from that of the triangle, about.
Watched watch(RandomStream& random, float bent = 0) {
  Watched w{random_look(random), {}, {}, {}};
  const auto any = [&] { return Vec3{random.next(), random.next(), random.next()}; };
  w.normal = normalize(any() - Vec3{0.5f, 0.5f, 0.5f});
  w.geometric = bent > 0 ? normalize(w.normal + (any() - Vec3{0.5f, 0.5f, 0.5f}) * bent) : w.normal;
  fill_rays(w.look.from, w.normal, w.geometric, hash64(7, uint64_t(1e6f * random.next())), {0, 256},
            w.batch);
  return w;
}

// Each ray that meets a box is in a cell that may, also where some are mirrored above the triangle;
// and of those of small boxes far away most cells are free.
TEST(CellsTowards, HoldEveryRayThatMeetsABox) {
  RandomStream random{13};
  const auto cones = cell_cones();
  size_t met = 0, small = 0, bits = 0;
  for (int k = 0; k < 2000; ++k) {
    const Watched w = watch(random, k % 2 == 0 ? 0.0f : 2.0f);
    const uint64_t cells =
        cells_towards(std::span(&w.look.box, 1), w.look.from, w.normal, w.geometric, cones);
    for (size_t r = 0; r < w.batch.rays.size(); ++r) {
      if (!meets_exactly(w.look.box, w.batch.rays[r], 0)) continue;
      ++met;
      EXPECT_TRUE(cells >> w.batch.cell_of(uint32_t(r)) & 1);
    }
    if (length(w.look.box.centre() - w.look.from) < 4 * w.look.box.diagonal()) continue;
    ++small, bits += size_t(std::popcount(cells));
  }
  EXPECT_GT(met, 10000u);
  EXPECT_GT(small, 100u);
  EXPECT_LT(bits, 16 * small);
}

TEST(MarkRays, OfSeveralBoxesAnyCountsAndNoneIsTakenBack) {
  const std::vector<Box3> boxes{{{1, -1, -1}, {2, 1, 1}}, {{-2, -1, -1}, {-1, 1, 1}}, {}};
  std::vector<trace::Ray> rays;
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    rays.push_back({{0, 0, 0}, 0, d, INFINITY});
  std::vector<uint8_t> again{0, 0, 0, 1};
  mark_all(boxes, rays, again);
  EXPECT_EQ(again, (std::vector<uint8_t>{1, 1, 0, 1})) << "an empty box is nowhere";
  mark_all({}, rays, again);
  mark_all(boxes, {}, {});
  EXPECT_EQ(again, (std::vector<uint8_t>{1, 1, 0, 1}));
}

/// Three elements, of which the middle one has no rays.
constexpr size_t kElements = 3;
constexpr uint32_t kPlaces = 1000;
RayTile some_tile() {
  RayTile out;
  out.followed = {FollowedRay::pack({1, 2, 3}, {true, {0, 0.6f, -0.8f}, true, true})};
  out.near_m = {0.25f, 0, 0};
  out.ends = {RayEnd::hit, RayEnd::escaped, RayEnd::followed, RayEnd::behind, RayEnd::back};
  out.hits.end = {2, 2, 3};  // that of the ray followed on, too
  for (const uint32_t base : {0u, 17u, kPlaces - 1})
    out.hits.entries.push_back(StoredHit::pack(base, 3, StoredHit::kSteps, {kNoTint, base > 5}));
  out.escaped.resize(kElements);
  out.escaped[0].add({1, 2, 3}, false), out.escaped[0].add({4, 1, 0}, true);
  return out;
}

class KeptRays : public WithFolder {
 protected:
  /// Writes into a file by way of a store that keeps everything, and opens the file.
  RecordFile kept(const std::function<void(PartStore&)>& write) {
    const fs::path file = folder_ / "rays";
    {
      PartStore store({file, "", "", 1e-9, std::chrono::steady_clock::now()}, progress_);
      write(store);
    }
    Result<RecordFile> out = RecordFile::open(file);
    EXPECT_TRUE(out) << out.error().message;
    return std::move(*out);
  }
  Bytes bytes_of(const RayTile& tile) {
    const RecordFile file = kept([&](PartStore& store) { keep_rays(&store, 2, 7, tile); });
    Bytes out(file.size_of({2, 7}).value_or(0));
    EXPECT_TRUE(file.read({2, 7}, 0, out));
    return out;
  }
  std::optional<RayTile> found_in(const Bytes& bytes, size_t elements = kElements) {
    const RecordFile file = kept([&](PartStore& store) { store.keep({2, 7}, bytes); });
    return found_at(file, 2, 7, elements);
  }
  std::optional<RayTile> found_at(const RecordFile& file, uint64_t round, uint64_t tile,
                                  size_t elements = kElements) {
    const RayTile* found = find_rays(file, round, tile, elements, kPlaces, buffer_);
    return found ? std::optional(*found) : std::nullopt;
  }
  std::optional<RayTile> found_of(const std::function<void(RayTile&)>& edit) {
    RayTile tile = some_tile();
    edit(tile);
    return found_in(bytes_of(tile));
  }

  Progress progress_;
  RayTileBuffer buffer_;  ///< of whatever was found before: that must not show
};

TEST_F(KeptRays, AreFoundAsTheyWere) {
  const RayTile tile = some_tile();
  const RecordFile file = kept([&](PartStore& store) { keep_rays(&store, 2, 7, tile); });
  const auto found = found_at(file, 2, 7);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->ends, tile.ends);
  EXPECT_EQ(found->hits.end, tile.hits.end);
  ASSERT_EQ(found->hits.entries.size(), tile.hits.entries.size());
  for (size_t k = 0; k < tile.hits.entries.size(); ++k)
    EXPECT_EQ(found->hits.entries[k].bits, tile.hits.entries[k].bits);
  // By hand: luminances of (1, 2, 3) and (4, 1, 0), the second one of the second half.
  const float first = 0.2126f + 2 * 0.7152f + 3 * 0.0722f, second = 4 * 0.2126f + 0.7152f;
  EXPECT_EQ(found->escaped[0].sum, (Rgb{5, 3, 3}));
  EXPECT_FLOAT_EQ(found->escaped[0].luminance2, first * first + second * second);
  EXPECT_FLOAT_EQ(found->escaped[0].second_luminance, second);
  EXPECT_EQ(found->escaped[2].sum, Rgb{});
  ASSERT_EQ(found->followed.size(), 1u);
  EXPECT_EQ(found->followed[0].light, (Rgb{1, 2, 3}));
  EXPECT_EQ(found->followed[0].bits, tile.followed[0].bits);
  EXPECT_EQ(found->near_m, tile.near_m);
  EXPECT_FALSE(found_at(file, 2, 6)) << "of another tile";
  EXPECT_FALSE(found_at(file, 1, 7)) << "of another round";
}

TEST_F(KeptRays, OfATileWithoutAnyAreFound) {
  RayTile tile;
  tile.hits.end = {0, 0, 0}, tile.escaped.resize(kElements), tile.near_m.resize(kElements);
  const auto found = found_in(bytes_of(tile));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->ends.empty() && found->hits.entries.empty());
}

TEST_F(KeptRays, CutOffAnywhereAreRefused) {
  const Bytes bytes = bytes_of(some_tile());
  ASSERT_TRUE(found_in(bytes));
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(found_in(Bytes(bytes.begin(), bytes.begin() + ptrdiff_t(size)))) << size;
  Bytes longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(found_in(longer));
}

TEST_F(KeptRays, OfAnotherNumberOfElementsAreRefused) {
  const Bytes bytes = bytes_of(some_tile());
  for (const size_t elements : {kElements - 2, kElements - 1, kElements + 1, 50 * kElements})
    EXPECT_FALSE(found_in(bytes, elements)) << elements;
}

TEST_F(KeptRays, ThatEndWhereNothingIsAreRefused) {
  EXPECT_TRUE(found_of([](RayTile&) {}));
  const auto hit_at = [&](uint32_t base) {
    return found_of([&](RayTile& t) { t.hits.entries[1] = StoredHit::pack(base, 0, 0, {}); });
  };
  EXPECT_TRUE(hit_at(kPlaces - 1));
  EXPECT_FALSE(hit_at(kPlaces));
  EXPECT_FALSE(found_of([](RayTile& t) { t.hits.entries[2].bits = UINT64_MAX; }));
  EXPECT_TRUE(found_of([](RayTile& t) { std::swap(t.ends[4], t.ends[2]); }));
  EXPECT_FALSE(found_of([](RayTile& t) { t.ends[4] = RayEnd::followed; }))
      << "of one nothing is known";
  EXPECT_FALSE(found_of([](RayTile& t) { t.ends[2] = RayEnd::back; }))
      << "of one too much is known";
  EXPECT_FALSE(found_of([](RayTile& t) { t.ends[4] = RayEnd(uint8_t(RayEnd::followed) + 1); }));
  EXPECT_FALSE(found_of([](RayTile& t) { t.ends[0] = RayEnd(255); }));
  EXPECT_FALSE(found_of([](RayTile& t) { t.hits.end = {3, 2, 3}; })) << "before they begin";
}

// The number of rays and that of hits are added up to tell the record's size: not so that the sum
// wraps around and both are huge.
TEST_F(KeptRays, WithImpossibleNumbersAreRefused) {
  const Bytes bytes = bytes_of(some_tile());
  const size_t end_at = (kElements - 1) * sizeof(uint32_t);
  const size_t rays_at = kElements * (sizeof(uint32_t) + sizeof(EscapedLight) + sizeof(float));
  const size_t followed_at = rays_at + sizeof(uint64_t);
  const size_t rest = bytes.size() - rays_at - 2 * sizeof(uint64_t);
  for (const uint32_t hits : {4u, 1000u, UINT32_MAX}) {
    const uint64_t rays = rest - uint64_t(hits) * sizeof(StoredHit);  // wraps
    Bytes damaged = bytes;
    std::memcpy(damaged.data() + end_at, &hits, sizeof(hits));
    std::memcpy(damaged.data() + rays_at, &rays, sizeof(rays));
    EXPECT_FALSE(found_in(damaged)) << hits;
  }
  // The number of bytes wraps around: of 2^4 bytes each, 2^60 are none and 2^60 + 1 are one.
  for (const uint64_t followed : {uint64_t(1) << 60, (uint64_t(1) << 60) + 1, UINT64_MAX}) {
    Bytes damaged = bytes;
    std::memcpy(damaged.data() + followed_at, &followed, sizeof(followed));
    EXPECT_FALSE(found_in(damaged)) << followed;
  }
}

TEST_F(KeptRays, AreNotKeptWithoutAStoreThatWants) {
  keep_rays(nullptr, 0, 0, some_tile());
  keep_samples(nullptr, 0, {});
  PartStore never({folder_ / "none", "", "", 0, std::chrono::steady_clock::now()}, progress_);
  keep_rays(&never, 0, 0, some_tile());
  EXPECT_FALSE(fs::exists(folder_ / "none"));
}

TEST_F(KeptRays, ComeInRoundsWithTheirSamples) {
  const std::vector<uint16_t> first{4, 4, 4}, second{4, 65535, 8};
  const RecordFile file = kept([&](PartStore& store) {
    keep_samples(&store, 1, second), keep_samples(&store, 0, first);
    keep_rays(&store, 0, 0, some_tile());
    keep_samples(&store, 3, first);  // none comes before it
  });
  const auto rounds = earlier_rounds(file, kElements);
  ASSERT_TRUE(rounds);
  EXPECT_EQ(*rounds, (std::vector{first, second}));
  EXPECT_FALSE(earlier_rounds(file, kElements - 1));
  EXPECT_FALSE(earlier_rounds(file, kElements + 1));
  const RecordFile none = kept([&](PartStore& store) { keep_rays(&store, 0, 0, some_tile()); });
  EXPECT_FALSE(earlier_rounds(none, kElements)) << "of no finished round";
}

// Directions are known to kWayError, and 0 is 0; flags are what they were.
TEST(FollowedRay, IsUnpackedAsItWasPacked) {
  RandomStream random{15};
  for (uint32_t k = 0; k < 1000; ++k) {
    FollowedWay way{k % 2 == 0, {}, (k & 2) != 0, (k & 4) != 0};
    const auto component = [&] { return 2 * random.next() - 1; };
    if (k > 8) way.direction = normalize(Vec3{component(), component(), component()});
    if (k % 100 == 9) way.direction = {0, -1, 0};
    const FollowedRay ray = FollowedRay::pack({1, 2, float(k)}, way);
    const FollowedWay back = ray.way();
    EXPECT_EQ(ray.light, (Rgb{1, 2, float(k)}));
    EXPECT_EQ(back.is_plain, way.is_plain);
    EXPECT_EQ(back.has_hit, way.has_hit);
    EXPECT_EQ(ray.has_hit(), way.has_hit);
    EXPECT_EQ(back.second_half, way.second_half);
    if (!way.is_plain) continue;
    const Vec3 d = back.direction - way.direction;
    // And the rounding of floats around 1.
    EXPECT_LE(max_component(max(d, -d)), kWayError + 1e-6f);
    EXPECT_EQ(back.direction == Vec3{}, k <= 8);
  }
}

// Ways that start within some distance of the element: each that meets a box is marked, most others
// are not.
TEST(MarkFollowed, HoldsEveryWayThatMeetsABox) {
  RandomStream random{16};
  const auto component = [&] { return 2 * random.next() - 1; };
  size_t met = 0, marked = 0, all = 0;
  for (int k = 0; k < 3000; ++k) {
    const Look look = random_look(random);
    const float near_m = 0.05f * random.next();
    std::vector<RayEnd> ends;
    std::vector<FollowedRay> followed;
    std::vector<uint8_t> meets;
    for (int r = 0; r < 16; ++r) {
      ends.push_back(r % 3 == 0 ? RayEnd::hit : RayEnd::followed);
      meets.push_back(0);
      if (ends.back() == RayEnd::hit) continue;
      const Vec3 aside = normalize(Vec3{component(), component(), component()});
      const Vec3 direction = normalize(Vec3{component(), component(), component()});
      followed.push_back(FollowedRay::pack({}, {true, direction, false, false}));
      const trace::Ray way{look.from + aside * (near_m * random.next()), 0, direction, INFINITY};
      meets.back() = meets_exactly(look.box, way, 0);
    }
    std::vector<uint8_t> again(ends.size(), 0);
    mark_followed(std::span(&look.box, 1), look.from, near_m, ends, followed, again);
    for (size_t r = 0; r < ends.size(); ++r) {
      EXPECT_LE(meets[r], again[r]);
      EXPECT_TRUE(again[r] == 0 || ends[r] == RayEnd::followed);
      met += meets[r], marked += again[r], all += ends[r] == RayEnd::followed;
    }
  }
  EXPECT_GT(met, 1000u);
  EXPECT_LT(marked - met, all / 10);
}

TEST(MarkFollowed, WaysThatAreNotKnownAre) {
  const std::vector<RayEnd> ends{RayEnd::followed, RayEnd::escaped, RayEnd::followed};
  const std::vector<FollowedRay> followed{FollowedRay::pack({}, {true, {1, 0, 0}, true, false}),
                                          FollowedRay::pack({}, {false, {1, 0, 0}, true, false})};
  std::vector<uint8_t> again(3, 0);
  mark_followed({}, {}, 0.1f, ends, followed, again);
  EXPECT_EQ(again, (std::vector<uint8_t>{0, 0, 1}));
}

// Light that is taken away again is gone.
TEST(EscapedLight, ChangesBack) {
  EscapedLight light;
  light.add({1, 2, 3}, false), light.add({8, 4, 2}, true), light.add({0.5f, 1, 2}, true);
  light.take_away({8, 4, 2}, true), light.take_away({1, 2, 3}, false);
  EscapedLight expected;
  expected.add({0.5f, 1, 2}, true);
  // Rounding of sums of about 10, and of their squares.
  EXPECT_NEAR(luminance(light.sum), luminance(expected.sum), 1e-5f);
  EXPECT_NEAR(light.luminance2, expected.luminance2, 1e-4f);
  EXPECT_NEAR(light.second_luminance, expected.second_luminance, 1e-5f);
}

}  // namespace
}  // namespace luxel::gather
