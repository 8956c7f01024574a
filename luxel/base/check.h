// Broken contracts end the program at once, in every build.
#pragma once

namespace luxel {
inline namespace base {
/// Prints the condition and where it stands to stderr, then aborts.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);
}  // namespace base
}  // namespace luxel

#define LUXEL_CHECK(condition) \
  ((condition) ? void(0) : ::luxel::check_failed(#condition, __FILE__, __LINE__))
