#include "luxel/base/run_program.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "luxel/base/clock.h"

namespace luxel {
namespace {

Result<ProgramEnd> run_shell(const std::string& script, double seconds = 100) {
  return run_program({"/bin/sh", "-c", script}, seconds, 1 << 20);
}

TEST(RunProgram, HandsOverWhatWasWrittenAndHowItEnded) {
  const auto end = run_shell("printf 'a\\0b'; echo why >&2; cat; exit 3");  // no input
  ASSERT_TRUE(end) << end.error().message;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(end->out.data()), end->out.size()),
            std::string("a\0b", 3));
  EXPECT_EQ(end->err, "why\n");
  EXPECT_EQ(WEXITSTATUS(end->status), 3);
  EXPECT_FALSE(end->was_killed);
  const auto killed = run_shell("kill -SEGV $$");
  EXPECT_TRUE(killed && WIFSIGNALED(killed->status) && WTERMSIG(killed->status) == SIGSEGV);
}

TEST(RunProgram, WhatTakesTooLongIsKilled) {
  const Clock::time_point start = Clock::now();
  const auto end = run_shell("exec sleep 1000", 0.1);
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->was_killed);
  EXPECT_LT(seconds_since(start), 100);
}

TEST(RunProgram, WhatWritesTooMuchIsAnError) {
  const auto end = run_shell("head -c 2000000 /dev/zero");
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, ErrorCode::out_of_memory);
}

TEST(RunProgram, AMissingProgramIsAnError) {
  const auto end = run_program({"/nowhere/at-all"}, 1, 0);
  ASSERT_FALSE(end);
  EXPECT_NE(end.error().message.find("/nowhere/at-all: No such file"), std::string::npos);
}

// Threads of a bake block the signals that ask it to stop; a program must be able to get them. No
// file of this process is open in it.
TEST(RunProgram, InheritsNeitherBlockedSignalsNorFiles) {
  sigset_t blocked;
  ::sigemptyset(&blocked), ::sigaddset(&blocked, SIGTERM);
  std::thread([&] {
    ::pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
    const auto end = run_shell("kill -TERM $$; exit 0");
    EXPECT_TRUE(end && WIFSIGNALED(end->status) && WTERMSIG(end->status) == SIGTERM);
  }).join();
  const int open = ::dup(STDERR_FILENO);
  const auto end = run_shell("ls /proc/$$/fd");
  ::close(open);
  ASSERT_TRUE(end);
  const std::string list(reinterpret_cast<const char*>(end->out.data()), end->out.size());
  EXPECT_EQ(list.find(std::to_string(open) + "\n"), std::string::npos) << list;
}

}  // namespace
}  // namespace luxel
