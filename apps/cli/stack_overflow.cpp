// A last net under the readers of other libraries. luxel checks depth before it gives them a file,
// where it knows the format; the stack may still overflow in the others (--any-format).
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include "apps/cli/cli.h"

namespace luxel::cli {
namespace {

/// The end of the stack, towards which it grows. A kernel keeps 1 MiB free below it.
uintptr_t end_of_stack = 0;
bool json_wanted = false, events_wanted = false;
std::atomic<bool> has_overflowed{false};
static_assert(std::atomic<bool>::is_always_lock_free);
constexpr uintptr_t kNear = 2 << 20;

void print(int stream, std::string_view text) {
  // Nothing can be done when it fails.
  if (::write(stream, text.data(), text.size()) < 0) return;
}

/// Only functions that may be called in a signal's handler.
[[noreturn]] void say_and_end() {
#define LUXEL_STACK_IS_FULL \
  "the stack is full; the parts of a file are nested too deeply, or in circles"
  print(STDERR_FILENO, events_wanted
                           ? "{\"event\":\"error\",\"code\":\"bad_input\",\"exit_code\":1,"
                             "\"message\":\"" LUXEL_STACK_IS_FULL "\"}\n"
                           : "luxel: " LUXEL_STACK_IS_FULL "\n");
  if (json_wanted)
    print(STDOUT_FILENO,
          "{\"error\": {\"code\": \"bad_input\", \"exit_code\": 1, \"message\": "
          "\"" LUXEL_STACK_IS_FULL "\"}}\n");
  ::_exit(kBadInput);
}

/// Only functions that may be called in a signal's handler.
[[maybe_unused]] void on_fault(int signal, siginfo_t* info, void*) {
  const auto at = reinterpret_cast<uintptr_t>(info->si_addr);
  if (at < end_of_stack - kNear || at > end_of_stack + kNear) {
    // Another fault: the instruction runs again, and ends the process as it would have before.
    std::signal(signal, SIG_DFL);
    return;
  }
  has_overflowed = true;
  timespec patience{0, 500'000'000};
  while (::nanosleep(&patience, &patience) != 0) continue;
  say_and_end();
}

}  // namespace

bool stack_has_overflowed() { return has_overflowed; }
void end_after_overflow() { say_and_end(); }

void say_when_the_stack_overflows(const Common& messages) {
  json_wanted = messages.json, events_wanted = messages.progress_json;
#ifndef __SANITIZE_ADDRESS__  // it has a handler of its own, which says more
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return;
  void* lowest = nullptr;
  size_t size = 0;
  const bool known = pthread_attr_getstack(&attributes, &lowest, &size) == 0;
  pthread_attr_destroy(&attributes);
  if (!known) return;
  end_of_stack = reinterpret_cast<uintptr_t>(lowest);
  // The handler cannot stand on the stack that is full.
  static char stack[64 << 10];
  stack_t own{};
  own.ss_sp = stack, own.ss_size = sizeof stack;
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  if (::sigaltstack(&own, nullptr) == 0) ::sigaction(SIGSEGV, &action, nullptr);
#endif
}

}  // namespace luxel::cli
