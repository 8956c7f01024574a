#include "luxel/base/record_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "luxel/base/file.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"

namespace luxel {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using Bytes = std::vector<std::byte>;

/// Some bytes that depend on the key alone.
Bytes bytes_for(RecordKey key, size_t count) {
  Bytes out(count);
  for (size_t i = 0; i < count; ++i) out[i] = std::byte(hash64(key.stage ^ key.part << 8, i));
  return out;
}

std::optional<Bytes> record(const RecordFile& file, RecordKey key) {
  const auto size = file.size_of(key);
  if (!size) return std::nullopt;
  Bytes out(*size);
  if (!file.read(key, 0, out)) return std::nullopt;
  return out;
}

class RecordFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("luxel-records-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    path_ = folder_ / "work";
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Three records of 5, 0 and 90 bytes under a header.
  Bytes three_records() {
    auto file = RecordFile::create(path_, kHeader);
    EXPECT_TRUE(file) << file.error().message;
    for (size_t i = 0; i < kKeys.size(); ++i) {
      ends_.push_back(file->bytes());
      EXPECT_TRUE(file->append(kKeys[i], bytes_for(kKeys[i], kSizes[i])));
    }
    ends_.push_back(file->bytes());
    return *read_file(path_);
  }
  void write(const Bytes& bytes) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  }

  static constexpr std::string_view kHeader = "of a test";
  static constexpr std::array<RecordKey, 3> kKeys{{{7, 0}, {7, 1}, {1ull << 63, 4}}};
  static constexpr std::array<size_t, 3> kSizes{5, 0, 90};
  fs::path folder_, path_;
  std::vector<uint64_t> ends_;  ///< of the header, and of each record
};

TEST_F(RecordFiles, GiveBackWhatWasAppended) {
  three_records();
  EXPECT_FALSE(fs::exists(RecordFile::unfinished_name(path_)));
  const auto file = RecordFile::open(path_);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->header(), kHeader);
  EXPECT_EQ(file->record_count(), 3u);
  for (size_t i = 0; i < kKeys.size(); ++i)
    EXPECT_EQ(record(*file, kKeys[i]), bytes_for(kKeys[i], kSizes[i])) << i;
  EXPECT_FALSE(file->size_of({8, 0}));
  Bytes part(10), beyond(11);
  EXPECT_TRUE(file->read(kKeys[2], 80, part));
  const Bytes all = bytes_for(kKeys[2], 90);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), all.begin() + 80));
  EXPECT_FALSE(file->read(kKeys[2], 80, beyond));
}

TEST_F(RecordFiles, OfTwoRecordsWithOneKeyTheLaterCounts) {
  three_records();
  const Bytes other(12, std::byte{9});
  {
    auto file = RecordFile::open(path_);
    ASSERT_TRUE(file->append(kKeys[0], other));
    EXPECT_EQ(record(*file, kKeys[0]), other);
  }
  EXPECT_EQ(record(*RecordFile::open(path_), kKeys[0]), other);
}

// A kill leaves the file as long as it happened to be.
TEST_F(RecordFiles, CutAtAnyByteHoldWhatWasWholeAndGrowOn) {
  const Bytes whole = three_records();
  for (size_t cut = 0; cut < whole.size(); ++cut) {
    write({whole.begin(), whole.begin() + std::ptrdiff_t(cut)});
    auto file = RecordFile::open(path_);
    if (cut < ends_[0]) {  // a header appears under its name whole or not at all
      ASSERT_FALSE(file) << cut;
      EXPECT_THAT(file.error().message, HasSubstr("is damaged at byte"));
      continue;
    }
    ASSERT_TRUE(file) << cut << file.error().message;
    for (size_t i = 0; i < kKeys.size(); ++i) {
      const bool there = cut >= ends_[i + 1];
      EXPECT_EQ(record(*file, kKeys[i]).has_value(), there) << cut << ", record " << i;
      if (there) {
        EXPECT_EQ(record(*file, kKeys[i]), bytes_for(kKeys[i], kSizes[i]));
      }
    }
    // A shorter record than the one that was cut off: nothing may be left behind it.
    ASSERT_TRUE(file->append({5, 5}, bytes_for({5, 5}, 1)));
    const auto again = RecordFile::open(path_);
    ASSERT_TRUE(again) << cut << again.error().message;
    EXPECT_EQ(record(*again, {5, 5}), bytes_for({5, 5}, 1)) << cut;
  }
}

TEST_F(RecordFiles, WithAnyByteChangedAreRefused) {
  const Bytes whole = three_records();
  for (size_t at = 0; at < whole.size(); ++at)
    for (const uint8_t flip : {0x01, 0x80, 0xff}) {
      Bytes bytes = whole;
      bytes[at] ^= std::byte{flip};
      write(bytes);
      const auto file = RecordFile::open(path_);
      ASSERT_FALSE(file) << "byte " << at;
      EXPECT_THAT(file.error().message, HasSubstr(path_.string() + " is damaged at byte"));
      EXPECT_THAT(file.error().message, HasSubstr("remove it and start over"));
    }
}

TEST_F(RecordFiles, CheckedWhenReadLoseOneRecordToADamagedByte) {
  const Bytes whole = three_records();
  for (size_t at = 0; at < whole.size(); ++at) {
    Bytes bytes = whole;
    bytes[at] ^= std::byte{0x10};
    write(bytes);
    const auto file = RecordFile::open(path_, RecordFile::Check::when_read);
    if (!file) continue;  // the start of the file, its header, or the start of a record
    for (size_t i = 0; i < kKeys.size(); ++i) {
      const bool hit = at >= ends_[i] && at < ends_[i + 1];
      const auto read = file->read_whole(kKeys[i]);
      EXPECT_EQ(read.has_value(), !hit) << "byte " << at << ", record " << i;
      EXPECT_EQ(read.value_or(bytes_for(kKeys[i], kSizes[i])), bytes_for(kKeys[i], kSizes[i]));
    }
  }
}

TEST_F(RecordFiles, OfOthersAreRefused) {
  EXPECT_THAT(RecordFile::open(path_).error().message, HasSubstr("No such file"));
  write(Bytes(4096, std::byte{0}));
  EXPECT_THAT(RecordFile::open(path_).error().message, HasSubstr("format 2"));
  EXPECT_FALSE(RecordFile::open(folder_));
  const auto made = RecordFile::create(folder_ / "none" / "work", "");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::io);
}

// A folder of another's may hold a link with the name of the file: nothing grows elsewhere.
TEST_F(RecordFiles, AreNoSymbolicLinks) {
  const Bytes before = three_records();
  const fs::path elsewhere = folder_ / "elsewhere";
  fs::rename(path_, elsewhere);
  fs::create_symlink(elsewhere, path_);
  const auto file = RecordFile::open(path_);
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("is a symbolic link"));
  fs::create_symlink(elsewhere, RecordFile::unfinished_name(path_));
  EXPECT_FALSE(RecordFile::create(path_, kHeader));
  EXPECT_EQ(*read_file(elsewhere), before);
}

TEST_F(RecordFiles, TakeRecordsFromManyThreads) {
  constexpr size_t kCount = 2000;
  {
    auto file = RecordFile::create(path_, "");
    parallel_for(kCount, 1, [&](size_t begin, size_t) {
      const RecordKey key{1, begin};
      EXPECT_TRUE(file->append(key, bytes_for(key, begin % 50)));
      EXPECT_EQ(record(*file, key), bytes_for(key, begin % 50));
    });
  }
  const auto file = RecordFile::open(path_);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->record_count(), kCount);
  for (size_t i = 0; i < kCount; ++i)
    EXPECT_EQ(record(*file, {1, i}), bytes_for({1, i}, i % 50)) << i;
}

}  // namespace
}  // namespace luxel
