#ifdef LUXEL_MPI
#include "luxel/cluster/mpi_team.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>

#include "luxel/base/bytes.h"
#include "luxel/base/clock.h"

namespace luxel::cluster {
namespace {

/// What lies at the first member: the counter, and what the others have told.
enum Slot : int { kCounter, kUnits, kSkipped, kSlots };
constexpr int64_t kNoMore = int64_t(1) << 60;
/// What a header says of a member that has given up.
constexpr int64_t kGivenUp = -1;
/// So long others are waited for by a member that gives up [s]: what they work on ends soon then.
constexpr double kLastWait = 3;

/// MPI is called by one thread at a time, under `mutex_`.
class MpiTeam final : public Team {
 public:
  MpiTeam(MPI_Comm members, std::string node) : members_(members), node_(std::move(node)) {
    int rank = 0, size = 1;
    MPI_Comm_rank(members_, &rank), MPI_Comm_size(members_, &size);
    rank_ = uint32_t(rank), size_ = uint32_t(size);
    int64_t* slots = nullptr;
    MPI_Win_allocate(rank == 0 ? kSlots * sizeof(int64_t) : 0, sizeof(int64_t), MPI_INFO_NULL,
                     members_, &slots, &window_);
    MPI_Win_lock_all(MPI_MODE_NOCHECK, window_);
    if (rank != 0) return;
    reset_slots();
    server_ = std::thread([this] { serve(); });
  }
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;
  ~MpiTeam() override {
    ends_ = true;
    if (server_.joinable()) server_.join();
    if (has_failed_) return;  // the others are not there to end it together
    MPI_Win_unlock_all(window_);
    MPI_Win_free(&window_);
    MPI_Comm_free(&members_);
  }

  uint32_t rank() const override { return rank_; }
  uint32_t size() const override { return size_; }

  Status begin_stage(Progress& progress) override {
    if (rank_ == 0) {
      const std::lock_guard lock(mutex_);
      reset_slots();
    }
    return all_gather({}, progress).map([](const auto&) {});
  }

  uint64_t next(uint64_t count) override {
    const std::lock_guard lock(mutex_);
    if (has_failed_) return uint64_t(kNoMore);
    return uint64_t(add(kCounter, int64_t(count)));
  }

  void tell(Done done) override {
    const std::lock_guard lock(mutex_);
    if (has_failed_) return;
    add(kUnits, int64_t(done.units)), add(kSkipped, int64_t(done.skipped));
  }
  Done told() override {
    const std::lock_guard lock(mutex_);
    if (has_failed_) return {};
    const Done now{uint64_t(add(kUnits, 0)), uint64_t(add(kSkipped, 0))};
    const Done before = std::exchange(told_, now);
    return {now.units - before.units, now.skipped - before.skipped};
  }

  Result<std::vector<std::vector<std::byte>>> all_gather(std::span<const std::byte> own,
                                                         Progress& progress) override {
    LUXEL_TRY(const std::vector<int64_t> bytes, gather_headers(int64_t(own.size()), progress));
    ++gathered_.times;
    for (const int64_t of_one : bytes) gathered_.bytes += uint64_t(of_one);
    return gather_bytes(own, bytes, progress);
  }

  Gathered gathered() const override { return gathered_; }

  void give_up(const Error& error) override {
    if (has_failed_) return;
    {
      const std::lock_guard lock(mutex_);
      add(kCounter, kNoMore);
    }
    Progress last;
    const Clock::time_point start = Clock::now();
    is_last_ = [start] { return seconds_since(start) > kLastWait; };
    if (headers(kGivenUp, last)) {
      const std::string text = fmt::format("{:c}process {} of {} ({}): {}", char(int(error.code)),
                                           rank_, size_, node_, error.message);
      std::ignore = gather_errors(text, last);
    }
    has_failed_ = true;
  }

 private:
  /// Adds to a slot of the first member. Returns what was there before.
  int64_t add(Slot slot, int64_t value) {
    int64_t before = 0;
    MPI_Fetch_and_op(&value, &before, MPI_INT64_T, 0, slot, value == 0 ? MPI_NO_OP : MPI_SUM,
                     window_);
    MPI_Win_flush(0, window_);
    return before;
  }
  void reset_slots() {
    const std::array<int64_t, kSlots> none{};
    MPI_Accumulate(none.data(), kSlots, MPI_INT64_T, 0, 0, kSlots, MPI_INT64_T, MPI_REPLACE,
                   window_);
    MPI_Win_flush(0, window_);
    told_ = {};
  }

  /// Answers the others while this member works on something else: some networks need MPI to be
  /// called at both ends.
  void serve() {
    while (!ends_) {
      {
        const std::lock_guard lock(mutex_);
        int there = 0;
        MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, members_, &there, MPI_STATUS_IGNORE);
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }

  /// Waits for a request. `is_moving`: all members are there, and bytes only move while MPI is
  /// called. Errors: cancelled.
  Status wait(MPI_Request& request, bool is_moving, Progress& progress) {
    auto pause = std::chrono::microseconds(is_moving ? 0 : 20);
    for (;;) {
      {
        const std::lock_guard lock(mutex_);
        int done = 0;
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done) return {};
      }
      if (progress.cancelled() || (is_last_ && is_last_())) {
        has_failed_ = true;  // the request stays open
        return fail(ErrorCode::cancelled, "cancelled");
      }
      if (is_moving) {
        std::this_thread::yield();
        continue;
      }
      std::this_thread::sleep_for(pause);
      pause = std::min(pause * 2, std::chrono::microseconds(1000));
      if (rank_ == 0) pass_on(progress);
    }
  }

  /// What others still do of a stage whose own pieces are done.
  void pass_on(Progress& progress) {
    const Done others = told();
    if (others.units == 0) return;
    progress.skip(others.skipped), progress.advance(others.units - others.skipped);
  }

  /// One number of each member. Errors: cancelled.
  Result<std::vector<int64_t>> headers(int64_t own, Progress& progress) {
    std::vector<int64_t> out(size_);
    MPI_Request request = MPI_REQUEST_NULL;
    {
      const std::lock_guard lock(mutex_);
      MPI_Iallgather(&own, 1, MPI_INT64_T, out.data(), 1, MPI_INT64_T, members_, &request);
    }
    LUXEL_TRY_STATUS(wait(request, false, progress));
    return out;
  }

  /// The same; errors, besides: a member has given up.
  Result<std::vector<int64_t>> gather_headers(int64_t own, Progress& progress) {
    if (has_failed_) return fail(ErrorCode::cancelled, "another process has given up");
    LUXEL_TRY(std::vector<int64_t> out, headers(own, progress));
    if (std::ranges::find(out, kGivenUp) == out.end()) return out;
    const Error error = gather_errors({}, progress);
    has_failed_ = true;
    return tl::unexpected(error);
  }

  /// What members say that have given up: the first one's error.
  Error gather_errors(const std::string& own, Progress& progress) {
    const auto sizes = headers(int64_t(own.size()), progress);
    if (!sizes) return sizes.error();
    const auto all = gather_bytes(std::as_bytes(std::span(own)), *sizes, progress);
    if (!all) return all.error();
    for (const std::vector<std::byte>& bytes : *all) {
      if (bytes.empty()) continue;
      const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      return {ErrorCode(int(text.front())), text.substr(1)};
    }
    return {ErrorCode::io, "a process has given up without a word"};
  }

  Result<std::vector<std::vector<std::byte>>> gather_bytes(std::span<const std::byte> own,
                                                           std::span<const int64_t> sizes,
                                                           Progress& progress) {
    std::vector<int> counts(size_), offsets(size_);
    size_t sum = 0;
    for (uint32_t rank = 0; rank < size_; ++rank) {
      counts[rank] = int(sizes[rank]), offsets[rank] = int(sum);
      sum += size_t(sizes[rank]);
    }
    std::vector<std::vector<std::byte>> out(size_);
    if (sum == 0) return out;
    std::vector<std::byte> all(sum);
    MPI_Request request = MPI_REQUEST_NULL;
    {
      const std::lock_guard lock(mutex_);
      MPI_Iallgatherv(own.data(), int(own.size()), MPI_BYTE, all.data(), counts.data(),
                      offsets.data(), MPI_BYTE, members_, &request);
    }
    LUXEL_TRY_STATUS(wait(request, true, progress));
    for (uint32_t rank = 0; rank < size_; ++rank) {
      const auto begin = all.begin() + offsets[rank];
      out[rank].assign(begin, begin + counts[rank]);
    }
    return out;
  }

  MPI_Comm members_;
  const std::string node_;
  uint32_t rank_ = 0, size_ = 1;
  MPI_Win window_ = MPI_WIN_NULL;
  std::mutex mutex_;
  std::thread server_;
  std::atomic<bool> ends_{false}, has_failed_{false};
  std::function<bool()> is_last_{};
  Done told_;
  Gathered gathered_;
};

}  // namespace

std::unique_ptr<Team> make_mpi_team(MPI_Comm members, std::string node) {
  return std::make_unique<MpiTeam>(members, std::move(node));
}

}  // namespace luxel::cluster
#endif
