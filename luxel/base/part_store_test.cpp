#include "luxel/base/part_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

namespace luxel {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;
using Clock = std::chrono::steady_clock;

const Bytes kSome(100, std::byte{3}), kOther(40, std::byte{5});

class PartStores : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("luxel-parts-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The work has begun so long ago.
  PartStoreParams params(double interval_s, double begun_s) const {
    return {folder_ / "parts", "of a test", "there is a way", interval_s,
            Clock::now() - std::chrono::milliseconds(int(1000 * begun_s))};
  }
  fs::path folder_;
  Progress progress_;
};

TEST_F(PartStores, OfShortWorkWriteNothing) {
  PartStore store(params(3600, 0), progress_);
  EXPECT_FALSE(store.wants());
  EXPECT_FALSE(store.keep({1, 2}, kSome));
  EXPECT_FALSE(store.find({1, 2}));
  PartStore never(params(0, 1e6), progress_);
  EXPECT_FALSE(never.keep({1, 2}, kSome));
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(progress_.way_on(), "") << "what is stopped now is lost";
}

TEST_F(PartStores, KeepPartsOnceTheIntervalIsOver) {
  {
    PartStore store(params(3600, 3601), progress_);
    ASSERT_TRUE(store.keep({1, 2}, kSome));
    ASSERT_TRUE(store.keep({1, 3}, kOther));
    EXPECT_EQ(store.find({1, 2}), kSome);
    EXPECT_EQ(progress_.way_on(), "there is a way");
  }
  auto found = RecordFile::open(folder_ / "parts");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->header(), "of a test");
  Progress again;
  PartStore store(params(3600, 0), again, std::move(*found));
  EXPECT_EQ(again.way_on(), "there is a way");
  EXPECT_EQ(store.find({1, 2}), kSome);
  EXPECT_EQ(store.find({1, 3}), kOther);
  EXPECT_FALSE(store.find({2, 3}));
  EXPECT_EQ(store.parts_found(), 2u);
  EXPECT_TRUE(store.keep({2, 3}, kOther)) << "from the start on: else the same parts might be lost "
                                             "again and again";
  EXPECT_EQ(store.parts_kept(), 1u);
}

TEST_F(PartStores, ThatCannotBeMadeSaySoOnceAndLetTheWorkGoOn) {
  PartStoreParams nowhere = params(1, 2);
  nowhere.file = folder_ / "none" / "parts";
  PartStore store(nowhere, progress_);
  EXPECT_TRUE(store.wants());
  EXPECT_FALSE(store.keep({1, 2}, kSome));
  EXPECT_FALSE(store.keep({1, 3}, kSome));
  EXPECT_TRUE(store.has_failed());
  EXPECT_FALSE(store.wants());
  ASSERT_EQ(progress_.notes(0).size(), 1u);
  EXPECT_THAT(progress_.notes(0)[0], HasSubstr("No such file"));
  EXPECT_THAT(store.failure(), HasSubstr("goes on"));
}

// A limit on the size of files stands for a full disk.
TEST_F(PartStores, OnAFullDiskHoldWhatTheyHave) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  PartStore store(params(1, 2), progress_);
  uint64_t kept = 0;
  while (kept < 100 && store.keep({1, kept}, kSome)) ++kept;
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  // 49 bytes of header, and each record 140.
  EXPECT_EQ(kept, 6u);
  EXPECT_FALSE(store.keep({1, 50}, kOther)) << "it may be emptier by now, but parts are missing";
  EXPECT_THAT(store.failure(), HasSubstr("File too large"));
  EXPECT_EQ(store.find({1, 5}), kSome);
  const auto found = RecordFile::open(folder_ / "parts");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->record_count(), kept);
}

TEST(KeptStage, WithoutAStoreKeepsNothing) {
  const KeptStage none;
  EXPECT_FALSE(none.wants());
  EXPECT_FALSE(none.keep(1, kSome));
  EXPECT_FALSE(none.find(1));
}

}  // namespace
}  // namespace luxel
