// Work for a thread that has another priority than the one that asks for it.
#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

namespace luxel {
inline namespace base {

/// Guards a thread, which has the priority of whoever makes this: on Linux a thread that has
/// lowered its own cannot raise it again, nor that of threads which it begins.
class Errands {
 public:
  Errands();
  ~Errands();
  Errands(const Errands&) = delete;
  Errands& operator=(const Errands&) = delete;

  /// Calls `body` on that thread and returns when it has; throws what it throws. By one thread at a
  /// time.
  void run(const std::function<void()>& body);

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::packaged_task<void()> next_;  ///< under the mutex
  bool is_ending_ = false;           ///< under the mutex
  std::thread thread_;               ///< the last: it uses all of the others
};

}  // namespace base
}  // namespace luxel
