// Files that change while somebody looks at them.
#include "luxel/view/model/file_watch.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/scratch_folder.h"

namespace luxel::view {
namespace {

class FileWatchTest : public ::testing::Test {
 protected:
  /// Each write is a second after the one before, whatever the clock of files is good for.
  void write(const char* name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    time_ += std::chrono::seconds(1);
    std::filesystem::last_write_time(folder_ / name, time_);
  }
  testing_support::ScratchFolder scratch_;  // tests of this file run at the same time
  std::filesystem::path folder_ = scratch_.path;
  std::filesystem::file_time_type time_{std::chrono::hours(24)};
};

TEST_F(FileWatchTest, TellsOnceThatAFileHasChangedWhenItIsAtRest) {
  write("a.glb", "one");
  FileWatch watch = watch_file(folder_ / "a.glb");
  EXPECT_FALSE(has_changed(watch));
  write("a.glb", "two");
  EXPECT_FALSE(has_changed(watch)) << "perhaps it is being written";
  write("a.glb", "and more");
  EXPECT_FALSE(has_changed(watch));
  EXPECT_TRUE(has_changed(watch));
  EXPECT_FALSE(has_changed(watch));
}

TEST_F(FileWatchTest, WaitsForAFileThatIsGoneToComeBack) {
  write("a.glb", "one");
  FileWatch watch = watch_file(folder_ / "a.glb");
  std::filesystem::remove(folder_ / "a.glb");
  for (int look = 0; look < 3; ++look) EXPECT_FALSE(has_changed(watch));
  write("a.glb", "two");
  EXPECT_FALSE(has_changed(watch));
  EXPECT_TRUE(has_changed(watch));
}

TEST_F(FileWatchTest, AFolderChangesWithTheFilesOfItsBake) {
  write("baked.glb", "scene"), write("bake.json", "{}");
  FileWatch watch = watch_file(folder_);
  write("notes.txt", "not of the bake");
  for (int look = 0; look < 3; ++look) EXPECT_FALSE(has_changed(watch));
  write("lightmap.exr", "light");
  EXPECT_FALSE(has_changed(watch));
  EXPECT_TRUE(has_changed(watch));
}

}  // namespace
}  // namespace luxel::view
