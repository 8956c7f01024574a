// A small bake in which one call fails: each write, fsync, rename, open and read of its files, and
// allocations. Each ends with a right result, or with a code, a sentence and no half-written file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "tests/command.h"

namespace luxel::testing_support {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string bake(const std::filesystem::path& out) {
  return std::string(LUXEL_WITH_FAULTS) + " bake " + LUXEL_SOURCE_DIR +
         "/scenes/ies/wall.gltf -o " + out.string() +
         " --resolution 8 --samples 4 --direct-samples 2 --threads 1 --formats exr,hdr";
}

/// Counts of calls in a bake without faults, and the files that it leaves.
struct Whole {
  std::map<std::string, long> calls;
  std::set<std::string> files;
  std::string lightmap;
};
Whole whole_bake(const ScratchFolder& s, const std::string& more) {
  Whole out;
  const std::string counts = (s.path / "counts").string();
  const CommandResult r =
      shell("LUXEL_FAULT_COUNTS=" + counts + " " + bake(s.path / "whole") + more);
  EXPECT_EQ(r.code, 0) << r.err;
  std::istringstream in(slurp(counts));
  std::string name;
  for (long count; in >> name >> count;) out.calls[name] = count;
  out.files = files_in(s.path / "whole");
  out.lightmap = slurp(s.path / "whole/lightmap.exr");
  return out;
}

/// Runs the bake with that fault.
void expect_an_end(const std::string& fault, const std::string& more, const Whole& whole,
                   const ScratchFolder& s) {
  SCOPED_TRACE(fault + more);
  const std::filesystem::path folder = s.path / "out";
  std::filesystem::remove_all(folder);
  const CommandResult r = shell("LUXEL_FAULT=" + fault + " " + bake(folder) + more);
  EXPECT_THAT(r.code, AnyOf(0, 1, 3)) << r.err;
  if (r.code == 0) {
    std::set<std::string> files = files_in(folder);
    // A bake goes on without a cache that cannot be written, and says so.
    if (whole.files.contains("cache") && !files.contains("cache")) {
      EXPECT_THAT(r.err, HasSubstr("the bake is not kept"));
      files.insert("cache");
    }
    EXPECT_EQ(files, whole.files);
    EXPECT_EQ(slurp(folder / "lightmap.exr"), whole.lightmap);
    return;
  }
  EXPECT_THAT(r.err, HasSubstr("luxel: "));
  EXPECT_THAT(r.err, Not(HasSubstr("internal error")));
  if (!std::filesystem::exists(folder)) return;
  for (const std::string& name : files_in(folder)) {
    EXPECT_THAT(name, Not(HasSubstr(".partial-")));
    EXPECT_THAT(name, Not(HasSubstr(".replaced-")));
  }
}

TEST(Faults, OfFilesEndWithASentenceOrARightResult) {
  const ScratchFolder s;
  const std::string more = " --checkpoint 0";
  const Whole whole = whole_bake(s, more);
  for (const char* call : {"write", "fsync", "rename", "open", "pread"}) {
    ASSERT_GT(whole.calls.at(call), 0) << call;
    for (long n = 1; n <= whole.calls.at(call); ++n)
      expect_an_end(fmt::format("{}:{}:ENOSPC", call, n), more, whole, s);
  }
  // A call that is interrupted or cut short goes on.
  for (const char* call : {"write", "pread"})
    for (long n = 1; n <= whole.calls.at(call); ++n)
      for (const char* how : {"EINTR", "SHORT"}) {
        const std::string fault = fmt::format("{}:{}:{}", call, n, how);
        expect_an_end(fault, more, whole, s);
        EXPECT_TRUE(std::filesystem::exists(s.path / "out/lightmap.exr")) << fault;
      }
}

// A kept bake writes through pwrite() and reads its rays back.
TEST(Faults, OfCachesLeaveTheBakeAsItIs) {
  const ScratchFolder s;
  const std::string more = " --keep";
  const Whole whole = whole_bake(s, more);
  for (const char* call : {"pwrite", "pread", "rename", "ftruncate"})
    for (long n = 1; n <= whole.calls.at(call); n += 1 + whole.calls.at(call) / 12)
      expect_an_end(fmt::format("{}:{}:ENOSPC", call, n), more, whole, s);
}

/// Every `step`th of all allocations fails, from `first` on: of the options, which come first, and
/// of the bake.
void fail_allocations(long first, long step) {
  const ScratchFolder s;
  const std::string more = " --checkpoint 0";
  const Whole whole = whole_bake(s, more);
  ASSERT_GT(whole.calls.at("new"), 10'000);
  for (long n = first; n <= whole.calls.at("new"); n += step)
    expect_an_end(fmt::format("new:{}", n), more, whole, s);
}

TEST(Faults, OfSomeAllocationsEndWithASentence) { fail_allocations(1, 997); }

/// Together all of them; each part takes some ten minutes.
class FaultsSlow : public ::testing::TestWithParam<int> {};
TEST_P(FaultsSlow, OfEveryAllocationEndWithASentence) { fail_allocations(1 + GetParam(), 6); }
INSTANTIATE_TEST_SUITE_P(Parts, FaultsSlow, ::testing::Range(0, 6));

}  // namespace
}  // namespace luxel::testing_support
