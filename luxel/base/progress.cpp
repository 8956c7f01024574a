#include "luxel/base/progress.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace luxel {
inline namespace base {
namespace {

/// The running stage's own speed is all that counts when so much of it is done: pieces come from
/// everywhere (luxel/base/share_out.cpp), so that those to come are like those before them.
constexpr double kSureShare = 0.25;
constexpr double kMostWhileRunning = 0.99;
/// If past stages were slower than expected, the machine is a part of the reason, and stages to
/// come will be slower too; the rest of it concerns single stages. So this part of all work counts
/// as if it had taken what was expected, and the first moments say little.
constexpr double kAsExpected = 0.25;

}  // namespace

double seconds_left(const Expected& e) {
  const double usual = kAsExpected * (e.past + e.now + e.future);
  const auto slow = [&](double taken, double expected) {
    return expected > 0 ? (taken + usual) / (expected + usual) : 1;
  };
  // Whole time of the running stage: by the plan so far, or by its own speed.
  const double by_plan = e.now * slow(e.past_taken, e.past);
  const double by_speed = e.now_share > 0 ? e.now_taken / e.now_share : by_plan;
  const bool both = by_plan > 0 && by_speed > 0;
  const double trust = both ? std::min(1.0, e.now_share / kSureShare) : 1;
  const double whole = std::max(by_plan + trust * (by_speed - by_plan), e.now_taken);
  const double slow_now = slow(e.past_taken + whole, e.past + e.now);
  return whole - e.now_taken + slow_now * e.future;
}

void Progress::expect(std::vector<Stage> stages) {
  const std::lock_guard lock(mutex_);
  expected_ = std::move(stages), end_begins_.reset();
  sees_the_end_ = true;
  forget_past();
}

void Progress::expect_within(double seconds) {
  const std::lock_guard lock(mutex_);
  expected_.clear();
  end_begins_ = Clock::now() +
                std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  sees_the_end_ = true;
  forget_past();
}

void Progress::expect_at_end(std::vector<Stage> stages) {
  const std::lock_guard lock(mutex_);
  expected_at_end_ = std::move(stages);
}

void Progress::forget_past() {
  expected_s_ = taken_s_ = 0;
  if (!running_) awaited_ = {};
}

Stage Progress::take_expected(std::string_view stage) {
  for (std::vector<Stage>* list : {&expected_, &expected_at_end_}) {
    const auto found = std::ranges::find(*list, stage, &Stage::name);
    if (found == list->end()) continue;
    Stage out = *found;
    list->erase(list->begin(), found + 1);
    // Nothing of the first list comes after the second has begun.
    if (list == &expected_at_end_) expected_.clear(), end_begins_.reset();
    sees_the_end_ = true;
    return out;
  }
  return {};
}

void Progress::begin(std::string_view stage, uint64_t total) {
  finish();
  const std::lock_guard lock(mutex_);
  const bool is_next = !expected_.empty() && expected_.front().name == stage;
  if (!stages_.empty() && stages_.back().name == stage && !is_next) {
    // Units of a kind: its earlier parts tell how fast it goes.
    total_.fetch_add(total, std::memory_order_relaxed);
  } else {
    const Stage next = take_expected(stage);
    expected_s_ += expected_of_last(), taken_s_ += awaited_.name.empty() ? 0 : last_seconds();
    awaited_ = next;
    stage_start_ = Clock::now();
    if (stages_.empty()) start_ = stage_start_;
    stages_.push_back({std::string(stage), 0});
    done_ = 0, skipped_ = 0;
    total_ = total;
  }
  running_ = true;
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  if (running_) stages_.back().seconds = seconds_since(stage_start_);
  running_ = false;
}

double Progress::last_seconds() const {
  return running_ ? seconds_since(stage_start_) : stages_.back().seconds;
}

double Progress::expected_of_last() const {
  const double total = double(total_), skipped = double(skipped_);
  return awaited_.seconds * (total > 0 ? 1 - skipped / total : 1);
}

Progress::Snapshot Progress::snapshot() const {
  const std::lock_guard lock(mutex_);
  Snapshot s;
  if (stages_.empty()) return s;
  s.stage = stages_.back().name;
  s.done = done_;
  s.total = total_;
  s.skipped = skipped_;
  s.stage_seconds = last_seconds();
  s.stage_index = int(stages_.size()) - 1;
  s.seconds_left = seconds_left_now(s);
  s.share = share_now(s);
  return s;
}

double Progress::seconds_left_now(const Snapshot& s) const {
  if (!sees_the_end_) return -1;
  if (awaited_.name.empty() && expected_.empty() && expected_at_end_.empty() && !end_begins_)
    return -1;
  Expected e{.past = expected_s_, .past_taken = taken_s_};
  if (!awaited_.name.empty() && !running_) {
    e.past += expected_of_last(), e.past_taken += s.stage_seconds;
  } else if (!awaited_.name.empty()) {
    e.now = expected_of_last(), e.now_taken = s.stage_seconds;
    // Units that were there already take no time.
    const double total = double(s.total - s.skipped), done = double(s.done - s.skipped);
    if (total > 0) e.now_share = std::min(1.0, done / total);
  }
  for (const std::vector<Stage>* list : {&expected_, &expected_at_end_})
    for (const Stage& stage : *list) e.future += stage.seconds;
  if (end_begins_) e.future += std::max(0.0, -seconds_since(*end_begins_));
  return luxel::seconds_left(e);
}

double Progress::share_now(const Snapshot& s) const {
  if (s.seconds_left >= 0) {
    // The share of the work that is left falls to zero as evenly as the time left does. If that is
    // L now and was L + dt when somebody asked before, L / (L + dt) remains.
    const double now_s = seconds_since(start_), before_s = share_ < 0 ? 0 : share_s_;
    const double time = s.seconds_left + now_s - before_s;
    const double share = 1 - (1 - std::max(share_, 0.0)) * (time > 0 ? s.seconds_left / time : 0);
    // A running stage is not yet done.
    share_ = std::max(share_, running_ ? std::min(share, kMostWhileRunning) : share);
    share_s_ = now_s;
  }
  if (share_ >= 0) return share_;
  // The stages before the end are not known yet.
  if (!expected_at_end_.empty()) return -1;
  return s.total > 0 ? std::min(1.0, double(s.done) / double(s.total)) : -1;
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
