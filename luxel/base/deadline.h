// Ends work when its time is over.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "luxel/base/progress.h"

namespace luxel {
inline namespace base {

/// Asks the work of a Progress to stop when its time is over, unless the object is gone by then.
/// Work that was asked to stop ends with the error `cancelled`; passed() tells who asked.
class Deadline {
 public:
  /// `seconds` from now. `progress` outlives the object.
  Deadline(Progress& progress, double seconds);
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  ~Deadline();
  /// True: the time was over before the object's end. Thread-safe.
  bool passed() const { return passed_.load(); }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::atomic<bool> passed_{false};
  std::thread watcher_;
};

}  // namespace base
}  // namespace luxel
