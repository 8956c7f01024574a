// Parallel loops. The only file that includes TBB.
//
// Loops hand out disjoint index ranges, so a body that writes only its own range gives the same
// bits for any number of threads. Sums over a range are taken per fixed block, in block order.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace luxel {
inline namespace base {

/// Limits all parallel loops of the process while it lives. 0 means all cores.
class ThreadLimit {
 public:
  /// `threads` at most; 0: all cores.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
  int exceptions_before_;  ///< that were under way when it was made
};

/// The number of threads a loop started now may use.
int thread_count();

/// Calls body(begin, end) on ranges that cover [0, count), each at most `grain` long and starting
/// at a multiple of it. Denormal floats are flushed to zero inside the body (Embree asks for it).
void parallel_for(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body);

}  // namespace base
}  // namespace luxel
