#include "base/progress.h"

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
  done_ = 0;
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
  s.stage_seconds = running_ ? seconds_since(stage_start_) : stages_.back().seconds;
  s.stage_index = int(stages_.size()) - 1;
  return s;
}

std::vector<Stage> Progress::stages() const {
  const std::lock_guard lock(mutex_);
  return stages_;
}

}  // namespace base
}  // namespace luxel
