#include "base/progress.h"

#include <utility>

namespace luxel {
inline namespace base {
namespace {
double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
}  // namespace

void Progress::begin(std::string_view stage, uint64_t total) {
  finish();
  const std::lock_guard lock(mutex_);
  stages_.push_back({std::string(stage), 0});
  stage_start_ = Clock::now();
  done_ = 0, skipped_ = 0;
  total_ = total;
  running_ = true;
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  if (running_) stages_.back().seconds = seconds_since(stage_start_);
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

}  // namespace base
}  // namespace luxel
