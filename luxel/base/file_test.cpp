#include "luxel/base/file.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <set>
#include <string>

namespace luxel {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  if (!bytes) return "error: " + bytes.error().message;
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

/// An empty folder for each test, gone after it.
class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("luxel-file-test-" + std::to_string(::getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) found.insert(entry.path().filename());
    return found;
  }

  fs::path folder_;
};
using AtomicFiles = Files;

TEST_F(Files, ReadGivesBackWhatWasWritten) {
  std::string all(256, '\0');
  for (size_t i = 0; i < all.size(); ++i) all[i] = char(i);
  ASSERT_TRUE(write_file_atomically(folder_ / "all", bytes_of(all)));
  EXPECT_EQ(text_of(folder_ / "all"), all);
  ASSERT_TRUE(write_file_atomically(folder_ / "empty", {}));
  EXPECT_EQ(text_of(folder_ / "empty"), "");
  EXPECT_EQ(names(), (std::set<std::string>{"all", "empty"})) << "no temporary stays";
}

TEST_F(Files, ReadSaysWhatIsWrong) {
  const auto missing = read_file(folder_ / "nothing");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::io);
  EXPECT_NE(missing.error().message.find("nothing: no such file"), std::string::npos);
  const auto directory = read_file(folder_);
  ASSERT_FALSE(directory);
  EXPECT_NE(directory.error().message.find("is a folder"), std::string::npos);
  // A pipe that nobody writes to would be waited for.
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  for (const fs::path& path : {folder_ / "pipe", fs::path("/dev/zero")}) {
    const auto read = read_file(path);
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().message.find("is a pipe or a device"), std::string::npos);
  }
  if (::geteuid() == 0) return;  // root reads everything
  ASSERT_TRUE(write_file_atomically(folder_ / "secret", bytes_of("x")));
  fs::permissions(folder_ / "secret", fs::perms::none);
  const auto secret = read_file(folder_ / "secret");
  ASSERT_FALSE(secret);
  EXPECT_NE(secret.error().message.find("ermission"), std::string::npos);
}

TEST_F(AtomicFiles, AllAppearAndReplaceWhatWasThere) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a", bytes_of("old")));
  const std::vector<OutputFile> files{{folder_ / "a", bytes_of("new a")},
                                      {folder_ / "b", bytes_of("new b")}};
  ASSERT_TRUE(write_files_atomically(files));
  EXPECT_EQ(text_of(folder_ / "a"), "new a");
  EXPECT_EQ(text_of(folder_ / "b"), "new b");
  EXPECT_EQ(names(), (std::set<std::string>{"a", "b"}));
}

TEST_F(AtomicFiles, NoneAppearsWhenOneCannotBeWritten) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a", bytes_of("old")));
  const std::vector<OutputFile> files{{folder_ / "a", bytes_of("new")},
                                      {folder_ / "b", bytes_of("new")},
                                      {folder_ / "no such folder" / "c", bytes_of("new")}};
  const Status status = write_files_atomically(files);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::io);
  EXPECT_NE(status.error().message.find("no such folder/c"), std::string::npos);
  EXPECT_EQ(text_of(folder_ / "a"), "old");
  EXPECT_EQ(names(), (std::set<std::string>{"a"}));
}

// An empty name once matched every file that is no left-over, and all of them were removed.
TEST_F(AtomicFiles, APathWithoutANameIsAnErrorAndHarmsNothing) {
  std::ofstream(folder_ / "other") << "stays";
  EXPECT_FALSE(write_file_atomically(folder_ / "", bytes_of("new")));
  EXPECT_EQ(text_of(folder_ / "other"), "stays");
}

TEST_F(AtomicFiles, AFolderInTheWayIsAnError) {
  fs::create_directory(folder_ / "a");
  const Status status = write_file_atomically(folder_ / "a", bytes_of("x"));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::io);
  EXPECT_EQ(names(), (std::set<std::string>{"a"}));
}

TEST_F(AtomicFiles, AFolderInTheWayOfTheLastLeavesNone) {
  fs::create_directory(folder_ / "b");
  const std::vector<OutputFile> files{{folder_ / "a", bytes_of("new")},
                                      {folder_ / "b", bytes_of("new")}};
  const Status status = write_files_atomically(files);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("/b: a folder"), std::string::npos);
  EXPECT_EQ(names(), (std::set<std::string>{"b"})) << "all of them or none";
}

// A file that something is mounted on can be written beside, but nothing can be renamed onto it.
TEST_F(AtomicFiles, ARenameThatFailsBringsBackWhatWasReplaced) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a", bytes_of("old a")));
  ASSERT_TRUE(write_file_atomically(folder_ / "c", bytes_of("old c")));
  const fs::path busy = folder_ / "c";
  if (::mount(busy.c_str(), busy.c_str(), nullptr, MS_BIND, nullptr) != 0)
    GTEST_SKIP() << "cannot mount a file: " << std::strerror(errno);
  const std::vector<OutputFile> files{{folder_ / "a", bytes_of("new a")},
                                      {folder_ / "b", bytes_of("new b")},
                                      {busy, bytes_of("new c")},
                                      {folder_ / "d", bytes_of("new d")}};
  const Status status = write_files_atomically(files);
  EXPECT_EQ(::umount(busy.c_str()), 0);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("/c: "), std::string::npos);
  EXPECT_EQ(text_of(folder_ / "a"), "old a");
  EXPECT_EQ(text_of(folder_ / "c"), "old c");
  EXPECT_EQ(names(), (std::set<std::string>{"a", "c"}));
}

TEST_F(AtomicFiles, AnUnwritableFolderIsAnErrorAndStaysAsItWas) {
  // Not even root makes files in /proc; into other folders root may write whatever they say.
  const Status proc = write_file_atomically("/proc/luxel-file-test", bytes_of("x"));
  ASSERT_FALSE(proc);
  EXPECT_EQ(proc.error().code, ErrorCode::io);
  EXPECT_NE(proc.error().message.find("/proc/luxel-file-test"), std::string::npos);
  if (::geteuid() == 0) return;
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  const Status status = write_file_atomically(folder_ / "a", bytes_of("x"));
  fs::permissions(folder_, fs::perms::owner_all);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::io);
  EXPECT_TRUE(names().empty());
}

TEST_F(AtomicFiles, AFullDiskIsAnErrorAndLeavesNothing) {
  if (::mount("none", folder_.c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "cannot mount a small disk: " << std::strerror(errno);
  const std::vector<OutputFile> files{{folder_ / "fits", std::vector<std::byte>(1000)},
                                      {folder_ / "too big", std::vector<std::byte>(1 << 20)}};
  const Status status = write_files_atomically(files);
  const auto left = names();
  EXPECT_EQ(::umount(folder_.c_str()), 0);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::out_of_disk);
  EXPECT_NE(status.error().message.find("too big"), std::string::npos);
  EXPECT_TRUE(left.empty());
}

/// A process that has ended, and whose number nobody has yet.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST_F(Files, WhatAKillLeftGoesWithTheNextWrite) {
  const std::string dead = std::to_string(dead_process());
  const std::string living = std::to_string(::getppid());
  const std::set<std::string> others{"map.partial-" + living,        "map.replaced-" + living,
                                     "other.partial-" + dead,        "map.partial-x" + dead,
                                     "map.partial-" + dead + ".png", "map.partial-"};
  for (const std::string& name : others) std::ofstream(folder_ / name) << name;
  for (const char* mark : {"map.partial-", "map.replaced-", "list.partial-"})
    std::ofstream(folder_ / (mark + dead)) << mark;
  ASSERT_TRUE(write_file_atomically(folder_ / "map", bytes_of("new")));
  std::set<std::string> left = others;
  left.insert({"map", "list.partial-" + dead});
  EXPECT_EQ(names(), left);
  const std::vector<OutputFile> files{text_file(folder_ / "map", "newer"),
                                      text_file(folder_ / "list", "1")};
  ASSERT_TRUE(write_files_atomically(files));
  left.erase("list.partial-" + dead);
  left.insert("list");
  EXPECT_EQ(names(), left);
  EXPECT_EQ(text_of(folder_ / "map"), "newer");
}

}  // namespace
}  // namespace luxel
