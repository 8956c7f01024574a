// Progress and cancellation of long work, shared between the worker and whoever watches.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/clock.h"
#include "luxel/base/result.h"

namespace luxel {
inline namespace base {

/// One finished or running stage of the work.
struct Stage {
  std::string name;
  double seconds = 0;
};

/// Times of stages, expected and taken [s].
struct Expected {
  double past = 0, past_taken = 0;  ///< of stages that have ended, and what they took
  double now = 0, now_taken = 0;    ///< of the running one
  double now_share = 0;             ///< of it that is done; 0: not known
  double future = 0;                ///< of stages to come
};
/// Seconds to the end, if what is to come is as much slower than expected as what has come and a
/// quarter of all work that took what was expected. How fast the running stage goes counts for more
/// the more of it is done, and alone after a quarter.
double seconds_left(const Expected& e);

/// Work calls begin() per stage and advance() per tile or iteration, never per ray. A watcher may
/// read at any time from another thread. request_cancel() may be called from a signal handler;
/// work polls cancelled() at the same places where it advances, and at least every 0.2 s.
class Progress {
 public:
  /// Starts a stage of `total` units of work and ends the one before, or goes on with that, by so
  /// many units more, if it has the same name and the next one that is expected has not. Called by
  /// one thread.
  void begin(std::string_view stage, uint64_t total);
  /// Ends the last stage.
  void finish();
  /// Units of the running stage that are done. Thread-safe.
  void advance(uint64_t units) { done_.fetch_add(units, std::memory_order_relaxed); }
  /// Units that were there already, which says nothing about how long the others take.
  void skip(uint64_t units) {
    skipped_.fetch_add(units, std::memory_order_relaxed);
    advance(units);
  }

  /// The seconds that stages to come are expected to take, in order, instead of what was said
  /// before: by all that is known now, so that what earlier stages took counts no more. A stage
  /// that comes unexpected takes no place.
  void expect(std::vector<Stage> stages);
  /// Stages that come after all others, with what they are expected to take. They alone say nothing
  /// about what comes before them.
  void expect_at_end(std::vector<Stage> stages);
  /// All before the end takes so many seconds from now, whatever stages come.
  void expect_within(double seconds);

  /// Asks the work to stop, held or not. Thread-safe, also in a signal handler.
  void request_cancel() {
    cancelled_.store(true, std::memory_order_relaxed);
    set_paused(false);
  }
  /// True: the work was asked to stop. Returns only when the work may go on or is to end.
  /// Thread-safe.
  bool cancelled() const {
    if (is_paused_.load(std::memory_order_relaxed)) wait_while_paused();
    return cancelled_.load(std::memory_order_relaxed);
  }
  /// Holds the work where it next calls cancelled(), and lets it go on. Thread-safe.
  void set_paused(bool is_paused);
  /// True while it is held. Thread-safe.
  bool is_paused() const { return is_paused_.load(std::memory_order_relaxed); }

  /// State as a watcher sees it: the running stage, its units and the time [s].
  struct Snapshot {
    std::string stage;
    uint64_t done = 0, total = 0;
    uint64_t skipped = 0;  ///< of done
    double stage_seconds = 0;
    int stage_index = -1;
    double seconds_left = -1;  ///< of all that is expected; < 0: not known
    /// The share of all work, which never falls; of the stage alone where the end is not known;
    /// below 0 where neither is known. At first it is the time taken over that and the time left.
    /// Then it grows as it must to be 1 in the end, so that an estimate that is wrong for a moment
    /// does not move it.
    double share = -1;
  };
  /// The state now. Thread-safe.
  Snapshot snapshot() const;
  /// The stages so far with their wall-clock seconds.
  std::vector<Stage> stages() const;

  /// A sentence that people should read now rather than when the work is done. Thread-safe.
  void note(std::string text);
  /// All from number `first` on.
  std::vector<std::string> notes(size_t first) const;
  /// Sets the advice for someone who stops the work; empty: the work is lost. Thread-safe.
  void set_way_on(std::string text);
  /// The last text of set_way_on(). Thread-safe.
  std::string way_on() const;
  /// Sets the function to call before the process ends while the work still runs; empty: none.
  /// Thread-safe.
  void set_clean_up(std::function<void()> clean_up);
  /// Calls what set_clean_up() was given last, if anything. Thread-safe.
  void clean_up() const;

 private:
  mutable std::mutex mutex_;
  std::vector<Stage> stages_;
  std::vector<Stage> expected_, expected_at_end_;  ///< those that have come are taken away
  /// When the end begins, whatever stages come before it.
  std::optional<Clock::time_point> end_begins_;
  bool sees_the_end_ = false;            ///< what comes before it is expected, or it has begun
  Stage awaited_;                        ///< the running stage, as it was expected
  double expected_s_ = 0, taken_s_ = 0;  ///< of expected stages that have ended
  Clock::time_point start_, stage_start_;
  mutable double share_s_ = 0;  ///< seconds after the start, when a watcher last asked
  mutable double share_ = -1;   ///< and the share of all work then; < 0: nobody knew
  bool running_ = false;
  std::atomic<uint64_t> done_{0}, total_{0}, skipped_{0};
  std::vector<std::string> notes_;
  std::string way_on_;
  std::function<void()> clean_up_;
  void forget_past();
  Stage take_expected(std::string_view stage);
  double last_seconds() const;      ///< of the running stage, or the last one
  double expected_of_last() const;  ///< of it, without what was there already
  double seconds_left_now(const Snapshot& s) const;
  double share_now(const Snapshot& s) const;
  void wait_while_paused() const;
  std::atomic<bool> cancelled_{false}, is_paused_{false};
};

/// The error (cancelled) of work that was asked to stop; success while it may go on:
/// LUXEL_TRY_STATUS(stopped(progress)). Loops over threads end early when progress.cancelled(), and
/// whoever waits for them says so by this, for what they leave is not whole.
Status stopped(const Progress& progress);

}  // namespace base
}  // namespace luxel
