// The time that work has taken.
#pragma once

#include <chrono>
#include <ctime>

namespace luxel {
inline namespace base {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Seconds of all of this process's threads since a call of std::clock(). Those of a clock on the
/// wall say how busy the machine is, too.
inline double processor_seconds_since(std::clock_t start) {
  return double(std::clock() - start) / CLOCKS_PER_SEC;
}

}  // namespace base
}  // namespace luxel
