// Code that runs per frame asks for no memory. This program's operator new counts.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "luxel/solve/matrix/bc1.h"
#include "luxel/solve/matrix/bounces.h"
#include "luxel/solve/matrix/colour_matrix.h"
#include "luxel/solve/matrix/lxr_test_support.h"
#include "luxel/solve/matrix/matrix_test_support.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/relighter.h"
#include "luxel/solve/matrix/transfer.h"

namespace {
std::atomic<uint64_t> allocations{0};
std::atomic<size_t> largest{0};

void count(size_t bytes) {
  ++allocations;
  for (size_t before = largest; before < bytes && !largest.compare_exchange_weak(before, bytes);) {
  }
}
}  // namespace

// None inline: the compiler would see malloc() of one meet the delete of another, and warn.
// Arrays come here as well: the library's operator new[] calls this one.
[[gnu::noinline]] void* operator new(size_t bytes) {
  count(bytes);
  if (void* p = std::malloc(bytes > 0 ? bytes : 1)) return p;
  throw std::bad_alloc();
}
// Sorting asks this one, and gives back to the operator delete below: a sanitizer wants both ours.
[[gnu::noinline]] void* operator new(size_t bytes, const std::nothrow_t&) noexcept {
  count(bytes);
  return std::malloc(bytes > 0 ? bytes : 1);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, const std::nothrow_t&) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, size_t) noexcept { std::free(p); }

namespace luxel::matrix {
namespace {

using testing::Cut;

/// Allocations of ten calls of `run`, once all threads have been at work.
template <class Run>
uint64_t allocations_of(const Run& run) {
  for (int warm_up = 0; warm_up < 3; ++warm_up) run();
  const uint64_t before = allocations;
  for (int k = 0; k < 10; ++k) run();
  return allocations - before;
}

TEST(Allocations, AreCounted) {
  int* volatile seen = nullptr;  // the compiler leaves out memory that nobody sees
  const auto allocate = [&] {
    std::vector<int> memory(100);
    seen = memory.data();
  };
  EXPECT_EQ(allocations_of(allocate), 10u);
}

TEST(Allocations, ThereAreNonePerFrame) {
  const Cut cut(scene::cornell_box(), 2000, 24);
  const Patches& p = cut.patches();
  const FormFactors factors = cut.reciprocal_factors(256);
  Progress progress;
  const auto matrix = compress(factors, cut.patched.tree, p.centroid, p.area_m2, {}, progress);
  const auto map =
      make_transfer(cut.patched, cut.tracer, {p.elements.position, p.elements.normal}, progress);
  ASSERT_TRUE(matrix && map);
  const CoarseScene coarse =
      make_coarse_scene(factors, cut.patched.tree, p.area_m2, p.elements.reflectance, 128);
  HierarchicalScratch scratch = make_scratch(*matrix);
  BounceScratch bounces = make_bounce_scratch(cut.size(), coarse.count());
  std::vector<Rgb> e(cut.size()), of_place(cut.size());
  const Multiply product = [&](std::span<const Rgb> b, std::span<Rgb> out) {
    multiply(*matrix, b, out, scratch);
  };
  const Sent sent{p.emission, p.elements.reflectance, p.area_m2, 3};
  EXPECT_EQ(allocations_of([&] { multiply(*matrix, p.emission, e, scratch); }), 0u);
  EXPECT_EQ(allocations_of([&] { count_bounces(product, sent, e, bounces); }), 0u);
  EXPECT_EQ(allocations_of([&] { all_bounces(product, coarse, sent, 3, e, bounces); }), 0u);
  EXPECT_EQ(allocations_of([&] { transfer(*map, e, of_place); }), 0u);
  const auto spectrum =
      spectrum_of(factors, p.area_m2, {.count = 40, .iterations = 0, .seed = 1}, progress);
  ASSERT_TRUE(spectrum);
  const auto low = make_low_rank(*spectrum, 40, p.area_m2, p.elements.reflectance, progress);
  ASSERT_TRUE(low);
  LowRankScratch low_scratch = make_scratch(*low);
  for (const int count : {-1, 3})
    EXPECT_EQ(allocations_of([&] { irradiance_of(*low, p.emission, count, e, low_scratch); }), 0u);
}

TEST(Allocations, ThereAreNonePerUpdate) {
  const Cut cut(scene::cornell_box(), 300);
  Target target;
  target.kind = Target::Kind::vertices;
  target.position.assign(100, {0.5f, 1e-6f, 0.05f});
  target.normal.assign(100, {0, 1, 0}), target.geometric_normal = target.normal;
  using enum CodecKind;
  for (const CodecKind codec : {hierarchical, lowrank, bc1, dense32, dense16}) {
    RelightParams params;
    params.patches.count = 300, params.factors.rays_per_patch = 256, params.codec = codec;
    Progress progress;
    auto data = make_relight_data(cut.scene, cut.tracer, target, params, progress);
    ASSERT_TRUE(data);
    auto relighter = Relighter::make(std::move(*data), {true});
    ASSERT_TRUE(relighter);
    std::array<scene::PunctualLight, 2> lamps;
    const std::vector<Rgb> emission(cut.scene.materials.size(), {1, 2, 3});
    float brightest = 0;
    EXPECT_EQ(allocations_of([&] {
                lamps[0].position = lamps[0].position + Vec3{0.02f, 0.02f, 0.02f};
                relighter->update({lamps, emission, {1, 1, 1}});
                for (const Rgb& e : relighter->latest().indirect)
                  brightest = std::max(brightest, e.x);
              }),
              0u)
        << int(codec);
    EXPECT_GT(brightest, 0) << int(codec);
  }
}

TEST(Allocations, OfADamagedFileAreNoLargerThanItJustifies) {
  // Every eight bytes in turn are taken for a length, with right checksums. 700 are fewer than the
  // bytes that are left, but too many elements of 12 bytes.
  const std::vector<std::byte> file = encode_lxr(testing::small_data());
  for (const uint64_t length :
       {uint64_t(700), uint64_t(1) << 32, uint64_t(1) << 60, (uint64_t(1) << 62) + 1, UINT64_MAX})
    for (size_t at = 32; at < file.size(); at += 8) {
      std::vector<std::byte> damaged = file;
      testing::put_at(damaged, at, length);
      testing::mend(damaged);
      largest = 0;
      const auto data = decode_lxr(damaged, "a.lxr");
      EXPECT_LE(largest, 2 * file.size()) << length << " at " << at;
    }
}

TEST(Allocations, ThereAreNonePerProductOfEntries) {
  const Cut cut(scene::cornell_box(), 300);
  const Patches& p = cut.patches();
  const FormFactors factors = cut.reciprocal_factors(256);
  Progress progress;
  const auto colour = make_reflections(factors, p.elements.reflectance, p.area_m2, 2, progress);
  ASSERT_TRUE(colour);
  const auto bc1 = make_bc1(*colour, {}, progress);
  ASSERT_TRUE(bc1);
  DenseScratch scratch = make_dense_scratch(cut.size());
  Bc1Scratch bc1_scratch = make_bc1_scratch(*bc1);
  std::vector<Rgb> e(cut.size());
  for (const Precision precision : {Precision::single, Precision::half}) {
    const Dense dense = make_dense(factors, precision);
    EXPECT_EQ(allocations_of([&] { multiply(dense, p.emission, e, scratch); }), 0u);
  }
  EXPECT_EQ(allocations_of([&] { multiply(*colour, p.emission, e, scratch); }), 0u);
  EXPECT_EQ(allocations_of([&] { multiply(*bc1, p.emission, e, bc1_scratch); }), 0u);
}

}  // namespace
}  // namespace luxel::matrix
