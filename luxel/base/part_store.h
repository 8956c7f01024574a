// Finished parts of long work, kept so that the work can go on after its process has ended.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "luxel/base/digest.h"
#include "luxel/base/progress.h"
#include "luxel/base/record_file.h"

namespace luxel {
inline namespace base {

/// The parts that a process works on, where several share those of a stage out.
struct PartShare {
  uint32_t number = 0, of = 1;  ///< every `of`-th part, from `number` on

  bool has(uint64_t part) const { return part % of == number; }
};

struct PartStoreParams {
  std::filesystem::path file;
  std::string header;  ///< of a file that is made
  /// The way to go on with stopped work: Progress::way_on() once there is a file.
  std::string way_on;
  /// Parts finished earlier than this after `start` are not kept: short work writes nothing. So
  /// often everything is flushed to the disk, too. 0: nothing is ever added.
  double interval_s = 30;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  std::optional<PartShare> share{};  ///< none: all parts are worked on
};

/// Parts are found again by what they were made from: a stage is the digest of its name and of
/// everything that its parts depend on besides what the file's header says. Work that has come to
/// a stage on another way than before, so that its input differs, finds nothing and does it anew.
///
/// A file that cannot be written any more (the disk is full) gets no more parts; the work goes on,
/// and `progress` gets a note. Thread-safe.
class PartStore {
 public:
  /// With `found`, a file to go on with, parts are kept from the start on. Parts are found in
  /// `others`, too, which stay as they are. `progress` outlives this.
  PartStore(PartStoreParams params, Progress& progress, std::optional<RecordFile> found = {},
            std::vector<RecordFile> others = {});
  PartStore(const PartStore&) = delete;
  PartStore& operator=(const PartStore&) = delete;

  /// True: keep() would keep a part now. Otherwise the part need not be put together.
  bool wants() const;
  /// Sets a digest of all else that later stages depend on: parts with another one are not found.
  void set_context(uint64_t context) { context_ = context; }
  /// Makes the file, which otherwise the first part to be kept does. Errors: it cannot be written.
  Status begin();
  /// Returns whether it was kept.
  bool keep(RecordKey part, std::span<const std::byte> bytes);
  std::optional<std::vector<std::byte>> find(RecordKey part) const;
  /// True: a part that was not found is left to others, because it is not of the share, or because
  /// its result could not be kept. Counts it.
  bool leaves(RecordKey part) const;
  uint64_t parts_left() const { return left_; }
  bool shares() const { return params_.share.has_value(); }
  /// Bytes of a part that was kept or found, from an offset on. False when the disk fails.
  bool read(RecordKey part, uint64_t offset, std::span<std::byte> out) const;

  const std::filesystem::path& file() const { return params_.file; }
  bool has_failed() const { return failed_; }
  /// The error on which has_failed() became true; none without one.
  std::optional<Error> error() const;
  /// The note about that error for work that goes on; empty without one.
  std::string failure() const;
  uint64_t parts_found() const { return found_; }
  uint64_t parts_kept() const { return kept_; }

 private:
  using Clock = std::chrono::steady_clock;
  RecordKey key_of(RecordKey part) const { return {part.stage ^ context_, part.part}; }
  const RecordFile* file_with(RecordKey key) const;
  bool make_file();
  void fail_locked(const Error& error);
  void flush_now_and_then();

  PartStoreParams params_;
  Progress& progress_;
  mutable std::mutex mutex_;
  std::optional<RecordFile> file_;  ///< made under the mutex, never taken away
  std::vector<RecordFile> others_;
  uint64_t context_ = 0;
  std::atomic<bool> has_file_{false}, failed_{false};
  std::optional<Error> error_;
  std::atomic<Clock::rep> flush_at_{0};
  mutable std::atomic<uint64_t> found_{0}, left_{0};
  std::atomic<uint64_t> kept_{0};
};

/// A stage of the work and where its parts are kept: nowhere, where there is no store.
struct KeptStage {
  PartStore* store = nullptr;
  uint64_t stage = 0;

  bool wants() const { return store != nullptr && store->wants(); }
  bool keep(uint64_t part, std::span<const std::byte> bytes) const {
    return store != nullptr && store->keep({stage, part}, bytes);
  }
  std::optional<std::vector<std::byte>> find(uint64_t part) const {
    return store == nullptr ? std::nullopt : store->find({stage, part});
  }
  bool leaves(uint64_t part) const { return store != nullptr && store->leaves({stage, part}); }
};

}  // namespace base
}  // namespace luxel
