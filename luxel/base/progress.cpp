#include "luxel/base/progress.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace luxel {
inline namespace base {
namespace {

/// How far the running stage's own speed is trusted, when it says so many times what was expected.
/// What was expected comes from work all over the stage, but its speed from that done so far, which
/// can be easier or harder than what is left: as far as that may be the reason it is trusted only
/// as far as the stage has come. From twice or half on the reason is the machine, which is sure
/// after a fifth.
double trust_in_speed(double times, double share) {
  const double doublings = std::abs(std::log2(times));
  const double sure_at = std::clamp(1 - 1.6 * (doublings - 0.5), 0.2, 1.0);
  return std::min(1.0, share / sure_at);
}

}  // namespace

double seconds_left(const Expected& e) {
  // What is left of the running stage: by the plan so far, or by its own speed.
  const double slow = e.past > 0 ? e.past_taken / e.past : 1;
  const double by_plan = e.now * slow;
  const double by_speed = e.now_share > 0 ? e.now_taken / e.now_share : by_plan;
  const bool both = by_plan > 0 && by_speed > 0;
  const double trust = both ? trust_in_speed(by_speed / by_plan, e.now_share) : 1;
  const double whole = std::max(by_plan + trust * (by_speed - by_plan), e.now_taken);
  const double past = e.past + e.now;
  const double slow_now = past > 0 ? (e.past_taken + whole) / past : 1;
  return whole - e.now_taken + slow_now * e.future;
}

void Progress::expect(std::vector<Stage> stages) {
  const std::lock_guard lock(mutex_);
  expected_ = std::move(stages), end_begins_.reset();
  sees_the_end_ = true;
}

void Progress::expect_within(double seconds) {
  const std::lock_guard lock(mutex_);
  expected_.clear();
  end_begins_ = Clock::now() +
                std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  sees_the_end_ = true;
}

void Progress::expect_at_end(std::vector<Stage> stages) {
  const std::lock_guard lock(mutex_);
  expected_at_end_ = std::move(stages);
}

void Progress::begin(std::string_view stage, uint64_t total) {
  finish();
  const std::lock_guard lock(mutex_);
  awaited_ = {};
  for (std::vector<Stage>* list : {&expected_, &expected_at_end_}) {
    const auto found =
        std::ranges::find_if(*list, [stage](const Stage& s) { return s.name == stage; });
    if (found == list->end()) continue;
    awaited_ = *found;
    list->erase(list->begin(), found + 1);
    // Nothing of the first list comes after the second has begun.
    if (list == &expected_at_end_) expected_.clear(), end_begins_.reset();
    sees_the_end_ = true;
    break;
  }
  stages_.push_back({std::string(stage), 0});
  stage_start_ = Clock::now();
  done_ = 0, skipped_ = 0;
  total_ = total;
  running_ = true;
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  if (running_) stages_.back().seconds = seconds_since(stage_start_);
  if (running_ && !awaited_.name.empty()) {
    const double total = double(total_), skipped = double(skipped_);
    expected_s_ += awaited_.seconds * (total > 0 ? 1 - skipped / total : 1);
    taken_s_ += stages_.back().seconds;
  }
  running_ = false;
}

Progress::Snapshot Progress::snapshot() const {
  const std::lock_guard lock(mutex_);
  Snapshot s;
  if (stages_.empty()) return s;
  s.stage = stages_.back().name;
  s.done = done_;
  s.total = total_;
  s.skipped = skipped_;
  s.stage_seconds = running_ ? seconds_since(stage_start_) : stages_.back().seconds;
  s.stage_index = int(stages_.size()) - 1;
  if (!sees_the_end_) return s;
  if (awaited_.name.empty() && expected_.empty() && expected_at_end_.empty() && !end_begins_)
    return s;
  Expected e{expected_s_, taken_s_, awaited_.seconds, 0, 0, 0};
  if (!awaited_.name.empty()) {
    e.now_taken = s.stage_seconds;
    // What was there already takes no time.
    const double total = double(s.total - s.skipped), done = double(s.done - s.skipped);
    if (s.total > 0) e.now *= total / double(s.total);
    if (total > 0) e.now_share = std::min(1.0, done / total);
  }
  for (const std::vector<Stage>* list : {&expected_, &expected_at_end_})
    for (const Stage& stage : *list) e.future += stage.seconds;
  if (end_begins_) e.future += std::max(0.0, -seconds_since(*end_begins_));
  s.seconds_left = luxel::seconds_left(e);
  return s;
}

std::vector<Stage> Progress::stages() const {
  const std::lock_guard lock(mutex_);
  return stages_;
}

void Progress::note(std::string text) {
  const std::lock_guard lock(mutex_);
  notes_.push_back(std::move(text));
}

std::vector<std::string> Progress::notes(size_t first) const {
  const std::lock_guard lock(mutex_);
  if (first >= notes_.size()) return {};
  return {notes_.begin() + std::ptrdiff_t(first), notes_.end()};
}

void Progress::set_way_on(std::string text) {
  const std::lock_guard lock(mutex_);
  way_on_ = std::move(text);
}

std::string Progress::way_on() const {
  const std::lock_guard lock(mutex_);
  return way_on_;
}

void Progress::set_clean_up(std::function<void()> clean_up) {
  const std::lock_guard lock(mutex_);
  clean_up_ = std::move(clean_up);
}

void Progress::clean_up() const {
  const std::lock_guard lock(mutex_);
  if (clean_up_) clean_up_();
}

void Progress::set_paused(bool is_paused) {
  // Work that was asked to stop is not held.
  if (is_paused && cancelled_.load(std::memory_order_relaxed)) return;
  is_paused_.store(is_paused, std::memory_order_relaxed);
  is_paused_.notify_all();
}

void Progress::wait_while_paused() const { is_paused_.wait(true, std::memory_order_relaxed); }

Status stopped(const Progress& progress) {
  if (progress.cancelled()) return fail(ErrorCode::cancelled, "stopped by the user");
  return {};
}

}  // namespace base
}  // namespace luxel
