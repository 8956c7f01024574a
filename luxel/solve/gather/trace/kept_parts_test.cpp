// Gather goes on with parts that were kept, and ends with the same bits.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "luxel/scene/procedural.h"
#include "luxel/solve/gather/gather_test_support.h"
#include "luxel/solve/gather/rays/hit_store.h"

namespace luxel::gather {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

/// A room with a penumbra, so that texels are averaged, and glass, so that rays have tints.
std::unique_ptr<Room> some_room() { return lay_out(scene::cornell_box(), 48); }

GatherParams some_params() {
  GatherParams params = with_samples(16, 8);
  params.supersample = 4;
  return params;
}

class KeptParts : public WithFolder {
 protected:
  fs::path file(const std::string& name) const { return folder_ / name; }

  /// Everything is kept from the first part on.
  std::unique_ptr<PartStore> store(const std::string& name, std::optional<RecordFile> found = {}) {
    return std::make_unique<PartStore>(
        PartStoreParams{file(name), "", "", 1e-9, std::chrono::steady_clock::now()}, progress_,
        std::move(found));
  }
  /// Copies the records that `wanted` takes, with their bytes changed by `edit`.
  void copy(const std::string& from, const std::string& to, const std::vector<RecordKey>& keys,
            const std::function<void(Bytes&)>& edit = {}) {
    const auto in = RecordFile::open(file(from));
    auto out = RecordFile::create(file(to), "");
    for (const RecordKey& key : keys) {
      Bytes bytes(*in->size_of(key));
      ASSERT_TRUE(in->read(key, 0, bytes));
      if (edit) edit(bytes);
      ASSERT_TRUE(out->append(key, bytes));
    }
  }

  /// A solution whose parts are all in the file "all" then.
  Gather solve_and_keep(const Room& room, const GatherParams& params) {
    const auto parts = store("all");
    GatherStores stores;
    stores.parts = parts.get();
    return solve(room, params, stores);
  }

  Progress progress_;
};

void expect_same_gather(const Gather& a, const Gather& b) {
  EXPECT_EQ(a.irradiance, b.irradiance);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.direct_variance, b.direct_variance);
  EXPECT_EQ(a.indirect_variance, b.indirect_variance);
  EXPECT_EQ(a.met_back, b.met_back);
  EXPECT_EQ(a.enclosed, b.enclosed);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.supersampled, b.supersampled);
  EXPECT_EQ(a.sweeps, b.sweeps);
}

Gather solve_with(const Room& room, const GatherParams& params, PartStore* parts,
                  GatherStores stores = {}) {
  stores.parts = parts;
  return solve(room, params, stores);
}

TEST_F(KeptParts, SomeOrAllOfThemGiveTheSameBits) {
  const auto room = some_room();
  for (const float max_error :
       {0.0f, 0.05f})  // in one round; in several, which build on each other
    for (const uint64_t memory : {UINT64_MAX, uint64_t(0)}) {  // 0: no hits in memory
      GatherParams params = some_params();
      params.max_error = max_error, params.max_samples = 128;
      const GatherStores stores{.hit_memory_bytes = memory, .scratch_folder = folder_};
      const Gather expected = solve(*room, params, stores);
      uint64_t all = 0;
      {
        const auto first = store("all");
        expect_same_gather(solve_with(*room, params, first.get(), stores), expected);
        all = first->parts_kept();
        EXPECT_EQ(first->parts_found(), 0u);
      }
      ASSERT_GT(all, 20u);
      auto found = RecordFile::open(file("all"));
      const std::vector<RecordKey> keys = found->keys();
      EXPECT_EQ(keys.size(), all);
      const auto again = store("all", std::move(*found));
      expect_same_gather(solve_with(*room, params, again.get(), stores), expected);
      EXPECT_EQ(again->parts_found(), all);
      EXPECT_EQ(again->parts_kept(), 0u);
      std::vector<RecordKey> half;
      for (const RecordKey& key : keys)
        if (hash64(key.stage, key.part) % 2) half.push_back(key);
      copy("all", "half", half);
      const auto some = store("half", *RecordFile::open(file("half")));
      expect_same_gather(solve_with(*room, params, some.get(), stores), expected);
      EXPECT_EQ(some->parts_found(), half.size());
      EXPECT_EQ(some->parts_kept(), all - half.size());
    }
}

/// Does a share of a solution. Returns how many parts are left to others.
uint64_t do_share(const Room& room, const GatherParams& params, PartShare share,
                  const std::vector<fs::path>& files) {
  Progress progress;
  std::vector<RecordFile> others;
  std::optional<RecordFile> own;
  for (size_t k = 0; k < files.size(); ++k) {
    if (!fs::exists(files[k])) continue;
    if (k == share.number)
      own = std::move(*RecordFile::open(files[k]));
    else
      others.push_back(std::move(*RecordFile::open_to_read(files[k])));
  }
  PartStore parts(
      PartStoreParams{files[share.number], "", "", 1e-9,
                      std::chrono::steady_clock::now() - std::chrono::seconds(1), share},
      progress, std::move(own), std::move(others));
  GatherStores stores;
  stores.parts = &parts;
  const auto done = gather(scene_of(room), nullptr, params, stores, {}, progress);
  EXPECT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::parts_missing) << done.error().message;
  return parts.parts_left();
}

// Each process does its share of a stage, and goes on when it finds what the others have done; the
// rest is done by one that finds all of it, after any of the passes.
TEST_F(KeptParts, AreSharedOutAndGiveTheSameBits) {
  const auto room = some_room();
  for (const float max_error : {0.0f, 0.05f}) {
    GatherParams params = some_params();
    params.max_error = max_error, params.max_samples = 128;
    params.more_shadow_rays = params.more_points = max_error == 0;
    const Gather expected = solve(*room, params);
    std::vector<fs::path> files;
    for (const char* name : {"a", "b", "c"})
      files.push_back(file(name + std::to_string(max_error)));
    uint64_t left = 1;
    for (int pass = 0; left > 0; ++pass) {
      ASSERT_LT(pass, 12);
      left = 0;
      for (uint32_t k = 0; k < 3; ++k) left += do_share(*room, params, PartShare{k, 3}, files);
      std::vector<RecordFile> all;
      for (const fs::path& one : files) all.push_back(std::move(*RecordFile::open_to_read(one)));
      PartStore found(PartStoreParams{file("merged"), "", "", 0}, progress_, {}, std::move(all));
      expect_same_gather(solve_with(*room, params, &found), expected);
      EXPECT_GT(found.parts_found(), 0u);
    }
  }
}

// Kept parts are used: other light in a part is other light in the result.
TEST_F(KeptParts, AreUsed) {
  const auto room = some_room();
  const GatherParams params = some_params();
  const Gather expected = solve_and_keep(*room, params);
  const std::vector<RecordKey> keys = RecordFile::open(file("all"))->keys();
  std::set<uint64_t> stages;
  for (const RecordKey& key : keys) stages.insert(key.stage);
  EXPECT_EQ(stages.size(), 3u) << "direct light, points of texels, rays";
  for (const uint64_t stage : stages) {
    std::vector<RecordKey> of_stage;
    for (const RecordKey& key : keys)
      if (key.stage == stage) of_stage.push_back(key);
    // The first number of every kind of part is that of its rays.
    copy("all", "edited", of_stage, [](Bytes& bytes) { bytes[2] ^= std::byte{1}; });
    const auto edited = store("edited", *RecordFile::open(file("edited")));
    const Gather result = solve_with(*room, params, edited.get());
    EXPECT_EQ(result.rays, expected.rays + of_stage.size() * 65536);
    EXPECT_EQ(result.irradiance, expected.irradiance);
  }
}

TEST_F(KeptParts, OfAnotherSizeAreMadeAgain) {
  const auto room = some_room();
  const GatherParams params = some_params();
  const Gather expected = solve_and_keep(*room, params);
  const std::vector<RecordKey> keys = RecordFile::open(file("all"))->keys();
  for (const bool longer : {false, true}) {
    copy("all", "edited", keys,
         [&](Bytes& bytes) { bytes.resize(longer ? bytes.size() + 1 : bytes.size() / 2); });
    const auto edited = store("edited", *RecordFile::open(file("edited")));
    expect_same_gather(solve_with(*room, params, edited.get()), expected);
  }
}

// The place of a hit is looked up without a check later.
TEST_F(KeptParts, WithHitsOutsideTheMapAreMadeAgain) {
  const auto room = some_room();
  const GatherParams params = some_params();
  const Gather expected = solve_and_keep(*room, params);
  copy("all", "edited", RecordFile::open(file("all"))->keys(), [&](Bytes& bytes) {
    if (bytes.size() < 20000) return;  // direct light
    std::fill(bytes.end() - sizeof(StoredHit), bytes.end(), std::byte{0xff});
  });
  const auto edited = store("edited", *RecordFile::open(file("edited")));
  expect_same_gather(solve_with(*room, params, edited.get()), expected);
}

// Rounds and guides are looked up by what a tile counts, and means are divided by it. Files of
// parts come from other machines.
TEST_F(KeptParts, WithCountsThatCannotBeAreMadeAgain) {
  const auto room = some_room();
  const GatherParams params = some_params();
  const Gather expected = solve_and_keep(*room, params);
  // Where a tile of 256 elements has samples, last and first round, guided, and light.
  for (const size_t at : {size_t(8), size_t(520), size_t(776), size_t(1032), size_t(3336)}) {
    copy("all", "edited", RecordFile::open(file("all"))->keys(), [&](Bytes& bytes) {
      if (bytes.size() < 20000) return;  // direct light
      std::fill_n(bytes.begin() + ptrdiff_t(at), 4, std::byte{0xff});
    });
    const auto edited = store("edited", *RecordFile::open(file("edited")));
    expect_same_gather(solve_with(*room, params, edited.get()), expected);
    EXPECT_GT(edited->parts_kept(), 0u) << "byte " << at << ": those tiles were made again";
  }
}

// Other settings than the ones that parts were made with find nothing.
TEST_F(KeptParts, AreFoundByWhatTheyWereMadeFrom) {
  const auto room = some_room();
  solve_and_keep(*room, some_params());
  GatherParams other = some_params();
  other.seed = 2;
  const auto again = store("all", *RecordFile::open(file("all")));
  expect_same_gather(solve_with(*room, other, again.get()), solve(*room, other));
  EXPECT_EQ(again->parts_found(), 0u);
}

}  // namespace
}  // namespace luxel::gather
