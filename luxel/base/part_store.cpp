#include "luxel/base/part_store.h"

#include <utility>

namespace luxel {
inline namespace base {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

std::string note_of(const Error& error) {
  return error.message + "; the work goes on, but parts finished from now on are not saved";
}

}  // namespace

PartStore::PartStore(PartStoreParams params, Progress& progress, std::optional<RecordFile> found,
                     std::vector<RecordFile> others)
    : params_(std::move(params)),
      progress_(progress),
      file_(std::move(found)),
      others_(std::move(others)) {
  has_file_ = file_.has_value();
  if (has_file_) progress_.set_way_on(params_.way_on);
  flush_at_ = (params_.start + seconds(params_.interval_s)).time_since_epoch().count();
}

bool PartStore::wants() const {
  if (failed_ || params_.interval_s <= 0) return false;
  return has_file_ || Clock::now() >= params_.start + seconds(params_.interval_s);
}

bool PartStore::keep(RecordKey part, std::span<const std::byte> bytes) {
  if (!wants() || !make_file()) return false;
  const Status kept = file_->append(key_of(part), bytes);
  if (!kept) {
    const std::lock_guard lock(mutex_);
    fail_locked(kept.error());
    return false;
  }
  ++kept_;
  flush_now_and_then();
  return true;
}

Status PartStore::begin() {
  if (make_file()) return {};
  return Failure{*error()};
}

bool PartStore::make_file() {
  if (has_file_) return true;
  const std::lock_guard lock(mutex_);
  if (has_file_ || failed_) return has_file_;
  Result<RecordFile> made = RecordFile::create(params_.file, params_.header);
  if (!made) {
    fail_locked(made.error());
    return false;
  }
  file_.emplace(std::move(*made));
  has_file_ = true;
  progress_.set_way_on(params_.way_on);
  return true;
}

void PartStore::fail_locked(const Error& error) {
  if (failed_.exchange(true)) return;
  error_ = error;
  if (!shares()) progress_.note("warning: " + note_of(error));
}

std::optional<Error> PartStore::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

std::string PartStore::failure() const {
  const std::optional<Error> happened = error();
  return happened ? note_of(*happened) : std::string();
}

/// When it is time, the first thread to come waits for the disk; the others go on.
void PartStore::flush_now_and_then() {
  Clock::rep due = flush_at_;
  const Clock::time_point now = Clock::now();
  if (now.time_since_epoch().count() < due) return;
  const Clock::rep next = (now + seconds(params_.interval_s)).time_since_epoch().count();
  if (flush_at_.compare_exchange_strong(due, next)) file_->flush();
}

/// Null: none has it.
const RecordFile* PartStore::file_with(RecordKey key) const {
  if (has_file_ && file_->size_of(key)) return &*file_;
  for (const RecordFile& other : others_)
    if (other.size_of(key)) return &other;
  return nullptr;
}

std::optional<std::vector<std::byte>> PartStore::find(RecordKey part) const {
  const RecordKey key = key_of(part);
  const RecordFile* file = file_with(key);
  if (!file) return std::nullopt;
  std::vector<std::byte> bytes(*file->size_of(key));
  if (!file->read(key, 0, bytes)) return std::nullopt;
  ++found_;
  return bytes;
}

bool PartStore::leaves(RecordKey part) const {
  if (!shares() || (params_.share->has(part.part) && !failed_)) return false;
  ++left_;
  return true;
}

bool PartStore::read(RecordKey part, uint64_t offset, std::span<std::byte> out) const {
  const RecordKey key = key_of(part);
  const RecordFile* file = file_with(key);
  return file && file->read(key, offset, out);
}

}  // namespace base
}  // namespace luxel
