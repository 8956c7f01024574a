#include "luxel/base/errands.h"

namespace luxel {
inline namespace base {

Errands::Errands() : thread_([this] { work(); }) {}

Errands::~Errands() {
  {
    const std::scoped_lock lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Errands::run(const std::function<void()>& body) {
  std::packaged_task<void()> task(body);
  std::future<void> done = task.get_future();
  {
    const std::scoped_lock lock(mutex_);
    next_ = std::move(task);
  }
  changed_.notify_all();
  done.get();
}

void Errands::work() {
  for (;;) {
    std::packaged_task<void()> task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return is_ending_ || next_.valid(); });
      if (!next_.valid()) return;
      task = std::move(next_);
      next_ = {};
    }
    task();
  }
}

}  // namespace base
}  // namespace luxel
