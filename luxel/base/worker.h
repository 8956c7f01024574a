// Work for somebody who must not wait for it, such as a window: a thread does what it is asked for.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/thread_priority.h"

namespace luxel {
inline namespace base {

/// Guards a thread of low priority. The newest request wins: it ends the one that is under way, and
/// takes the place of one that waits. What the former still hands over counts. Functions are called
/// by one thread, and none waits for the work but wait() and the destructor, which ends it.
template <class Request, class Out>
class Worker {
 public:
  /// Hands over a result; a request may have any number of them, before its work has ended. Where
  /// there is a function merge(Out newer, Out& last), a result that nobody has taken takes it in.
  using Hand = std::function<void(Out)>;
  /// Does the work of a request, and ends soon once progress.cancelled(). The thread alone calls
  /// it, so that it may keep a state from one request to the next. Errors go to whoever asked, but
  /// for `cancelled`; so does std::bad_alloc.
  using Work = std::function<Status(Request, const Hand&, Progress&)>;

  explicit Worker(Work work) : work_(std::move(work)), thread_([this] { run(); }) {}
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() {
    {
      const std::scoped_lock lock(mutex_);
      ends_ = true;
      progress_->request_cancel();
    }
    changed_.notify_all();
    thread_.join();
  }

  void ask(Request request) { ask(std::move(request), true); }
  /// As ask(), but what is under way comes to its end first.
  void ask_next(Request request) { ask(std::move(request), false); }
  /// Ends what is under way, and drops what is asked, what has come, and what would still come.
  void forget() {
    const std::scoped_lock lock(mutex_);
    asked_.reset(), results_.clear();
    is_forgotten_ = true;
    progress_->request_cancel();
  }
  /// Asks what is under way to end.
  void stop() {
    const std::scoped_lock lock(mutex_);
    progress_->request_cancel();
  }
  /// Holds what is under way, or lets it go on.
  void set_paused(bool is_paused) {
    const std::scoped_lock lock(mutex_);
    if (is_running_) progress_->set_paused(is_paused);
  }

  /// The results that have come since the last call, and the error if there was one.
  std::vector<Result<Out>> take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(results_, {});
  }
  /// True while anything is asked or under way.
  bool is_at_work() const {
    const std::scoped_lock lock(mutex_);
    return asked_ || is_running_;
  }
  /// True also while there is anything to be taken.
  bool is_busy() const {
    const std::scoped_lock lock(mutex_);
    return asked_ || is_running_ || !results_.empty();
  }
  /// True while what is under way is held, by whomever.
  bool is_paused() const {
    const std::scoped_lock lock(mutex_);
    return is_running_ && progress_->is_paused();
  }
  /// Where the newest request is.
  Progress::Snapshot snapshot() const { return progress()->snapshot(); }
  /// That of the request that is under way, or was last.
  std::shared_ptr<const Progress> progress() const {
    const std::scoped_lock lock(mutex_);
    return progress_;
  }
  /// Returns when nothing is asked and nothing is under way.
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !asked_ && !is_running_; });
  }

 private:
  void ask(Request request, bool ends_other) {
    {
      const std::scoped_lock lock(mutex_);
      if (ends_other) progress_->request_cancel();
      asked_.emplace(std::move(request));
    }
    changed_.notify_all();
  }
  /// The next request; none: there will be no other.
  std::optional<Request> next() {
    std::unique_lock lock(mutex_);
    is_running_ = false;
    changed_.notify_all();
    changed_.wait(lock, [this] { return ends_ || asked_; });
    if (ends_) return std::nullopt;
    progress_ = std::make_shared<Progress>();
    is_running_ = true, is_forgotten_ = false;
    return std::exchange(asked_, std::nullopt);
  }
  void keep(Result<Out> result) {
    const std::scoped_lock lock(mutex_);
    if (is_forgotten_) return;
    if constexpr (requires { merge(std::move(*result), *result); }) {
      if (result && !results_.empty() && results_.back())
        return merge(std::move(*result), *results_.back());
    }
    results_.push_back(std::move(result));
  }
  Status tried(Request request, const Hand& hand, Progress& progress) try {
    return work_(std::move(request), hand, progress);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "out of memory");
  }
  void run() {
    lower_priority_of_this_thread();
    const Hand hand = [this](Out out) { keep(std::move(out)); };
    while (std::optional<Request> request = next()) {
      const std::shared_ptr<Progress> progress = progress_;
      const Status done = tried(std::move(*request), hand, *progress);
      progress->finish();
      if (!done && done.error().code != ErrorCode::cancelled) keep(Failure{done.error()});
    }
  }

  const Work work_;
  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::optional<Request> asked_;
  std::vector<Result<Out>> results_;
  std::shared_ptr<Progress> progress_ = std::make_shared<Progress>();  ///< of the newest request
  bool is_running_ = false, is_forgotten_ = false, ends_ = false;
  std::thread thread_;  ///< the last: it uses all of the others
};

}  // namespace base
}  // namespace luxel
