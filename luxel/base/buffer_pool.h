// Buffers that tasks of a parallel loop hand on to one another.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

namespace luxel {
inline namespace base {

/// A task takes a buffer, of whatever was in it last, and gives it back: there are as many as tasks
/// that ran at the same time, and their memory is touched for the first time only once.
template <class T>
class BufferPool {
 public:
  T take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return {};
    T out = std::move(free_.back());
    free_.pop_back();
    return out;
  }
  void give(T buffer) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(buffer));
  }

 private:
  std::mutex mutex_;
  std::vector<T> free_;
};

}  // namespace base
}  // namespace luxel
