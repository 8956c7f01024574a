#ifdef LUXEL_MPI
#include "luxel/cluster/mpi_team.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <climits>
#include <mutex>
#include <optional>
#include <thread>

#include "luxel/base/bytes.h"
#include "luxel/base/check.h"
#include "luxel/base/clock.h"

namespace luxel::cluster {
namespace {

/// A member's message to the first one: it takes numbers of the counter, with or without an answer,
/// and tells the units done. A window with MPI_Fetch_and_op would do, but Open MPI has none over
/// TCP as Debian sets it up.
struct Request {
  uint64_t stage = 0;  ///< how many have begun: what comes late is of no stage any more
  uint64_t count = 0;
  Team::Done done{};
  bool wants_answer = false;
};
constexpr int kRequestTag = 1, kAnswerTag = 2;
constexpr uint64_t kNoMore = uint64_t(1) << 60;
/// Header of a member that has given up.
constexpr int64_t kGivenUp = -1;
/// So long others are waited for by a member that gives up [s].
constexpr double kLastWait = 3;

/// MPI is called by one thread at a time, under `mutex_`.
class MpiTeam final : public Team {
 public:
  MpiTeam(MPI_Comm members, std::string node) : members_(members), node_(std::move(node)) {
    int rank = 0, size = 1;
    MPI_Comm_rank(members_, &rank), MPI_Comm_size(members_, &size);
    rank_ = uint32_t(rank), size_ = uint32_t(size);
    MPI_Comm_dup(members_, &requests_);
    if (rank == 0) server_ = std::thread([this] { serve(); });
  }
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;
  ~MpiTeam() override {
    ends_ = true;
    if (server_.joinable()) server_.join();
    if (has_failed_) return;  // the others are not there to end it together
    // Others may work for long still: no core is used until they are here.
    Progress nobody;
    MPI_Request all = MPI_REQUEST_NULL;
    MPI_Ibarrier(members_, &all);
    std::ignore = wait(all, false, nobody);
    MPI_Comm_free(&requests_);
    MPI_Comm_free(&members_);
  }

  uint32_t rank() const override { return rank_; }
  uint32_t size() const override { return size_; }

  Status begin_stage(Progress& progress) override {
    if (rank_ == 0) {
      const std::lock_guard lock(counter_mutex_);
      counter_ = 0, told_ = {};
    }
    ++stage_;
    return all_gather({}, progress).map([](const auto&) {});
  }

  uint64_t next(uint64_t count) override {
    if (has_failed_) return kNoMore;
    const Request request{.stage = stage_, .count = count, .wants_answer = true};
    return rank_ == 0 ? count_up(request) : ask_first(request);
  }
  void tell(Done done) override {
    if (!has_failed_) send_to_first({.stage = stage_, .done = done});
  }
  Done told() override {
    const std::lock_guard lock(counter_mutex_);
    return std::exchange(told_, {});
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
    if (error.code == ErrorCode::cancelled) {
      has_failed_ = true;  // the others are stopped, too, or will be when this process has ended
      return;
    }
    // The counter is far beyond all pieces from here on: no member begins another one.
    const Clock::time_point start = Clock::now();
    is_last_ = [start] { return seconds_since(start) > kLastWait; };
    const Request no_more{.stage = stage_, .count = kNoMore};
    rank_ == 0 ? void(count_up(no_more)) : send_to_first(no_more);
    Progress last;
    if (headers(kGivenUp, last)) {
      const std::string text = fmt::format("{:c}process {} of {} ({}): {}", char(int(error.code)),
                                           rank_, size_, node_, error.message);
      std::ignore = gather_errors(text, last);
    }
    has_failed_ = true;
  }

 private:
  /// At the first member. Returns what the counter was.
  uint64_t count_up(const Request& request) {
    const std::lock_guard lock(counter_mutex_);
    if (request.stage == stage_)
      told_.units += request.done.units, told_.skipped += request.done.skipped;
    const uint64_t before = counter_;
    counter_ = std::min(counter_ + request.count, 2 * kNoMore);
    return before;
  }

  void send_to_first(const Request& request) {
    const std::lock_guard lock(mutex_);
    MPI_Send(&request, int(sizeof request), MPI_BYTE, 0, kRequestTag, requests_);
  }
  /// One thread of a member asks at a time.
  uint64_t ask_first(const Request& request) {
    const std::lock_guard one(asking_);
    send_to_first(request);
    uint64_t answer = kNoMore;
    MPI_Request waiting = MPI_REQUEST_NULL;
    {
      const std::lock_guard lock(mutex_);
      MPI_Irecv(&answer, int(sizeof answer), MPI_BYTE, 0, kAnswerTag, requests_, &waiting);
    }
    Progress nobody;
    return wait(waiting, true, nobody) ? answer : kNoMore;
  }

  /// Answers the others while this member works on something else.
  void serve() {
    while (!ends_ && !has_failed_) {
      if (!serve_one()) std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    while (serve_one()) {
    }
  }
  /// False: nobody has asked or told anything.
  bool serve_one() {
    const std::lock_guard lock(mutex_);
    if (has_failed_) return false;  // buffers of open requests may be gone
    int is_there = 0;
    MPI_Status from;
    MPI_Iprobe(MPI_ANY_SOURCE, kRequestTag, requests_, &is_there, &from);
    if (!is_there) return false;
    Request request;
    MPI_Recv(&request, int(sizeof request), MPI_BYTE, from.MPI_SOURCE, kRequestTag, requests_,
             MPI_STATUS_IGNORE);
    const uint64_t answer = count_up(request);
    if (request.wants_answer)
      MPI_Send(&answer, int(sizeof answer), MPI_BYTE, from.MPI_SOURCE, kAnswerTag, requests_);
    return true;
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
        const std::lock_guard lock(mutex_);
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

  /// At the first member: adds the units that others still do of a stage to its progress.
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

  /// headers(); errors, besides: a member has given up.
  Result<std::vector<int64_t>> gather_headers(int64_t own, Progress& progress) {
    if (has_failed_) return fail(ErrorCode::cancelled, "another process has stopped");
    LUXEL_TRY(std::vector<int64_t> out, headers(own, progress));
    if (std::ranges::find(out, kGivenUp) == out.end()) return out;
    const Error error = gather_errors({}, progress);
    has_failed_ = true;
    return Failure{error};
  }

  /// Gathers the errors of members that have given up. Returns the first member's.
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
    return {ErrorCode::io, "a process has stopped and gave no reason"};
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
    LUXEL_CHECK(sum <= size_t(INT_MAX));  // MPI counts in int; 5e8 texels send less at a time
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
  MPI_Comm requests_ = MPI_COMM_NULL;  ///< so that they meet nothing else
  std::mutex mutex_, asking_;
  std::mutex counter_mutex_;  ///< of the two below, at the first member
  uint64_t counter_ = 0;
  Done told_;
  std::thread server_;
  std::atomic<uint64_t> stage_{0};
  std::atomic<bool> ends_{false}, has_failed_{false};
  std::function<bool()> is_last_{};
  Gathered gathered_;
};

}  // namespace

std::unique_ptr<Team> make_mpi_team(MPI_Comm members, std::string node) {
  return std::make_unique<MpiTeam>(members, std::move(node));
}

}  // namespace luxel::cluster
#endif
