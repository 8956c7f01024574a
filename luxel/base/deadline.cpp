#include "luxel/base/deadline.h"

#include <algorithm>
#include <chrono>

namespace luxel {
inline namespace base {

Deadline::Deadline(Progress& progress, double seconds)
    : watcher_([this, &progress, seconds] {
        std::unique_lock lock(mutex_);
        const std::chrono::duration<double> time(std::max(seconds, 0.0));
        if (ended_.wait_for(lock, time, [this] { return end_; })) return;
        passed_ = true;
        progress.request_cancel();
      }) {}

Deadline::~Deadline() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  ended_.notify_all();
  watcher_.join();
}

}  // namespace base
}  // namespace luxel
