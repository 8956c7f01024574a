#include "luxel/base/share_out.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>

#include "luxel/base/parallel.h"

namespace luxel {
inline namespace base {
namespace {

/// Each member comes back for more about so many times per stage, which evens out what their last
/// pieces take.
constexpr uint64_t kTimesEach = 64;
constexpr uint64_t kMostAtATime = 64;

/// Pieces of a stage in an order in which those that follow each other lie far apart: parts of a
/// scene that are dear come evenly, so that the work done tells how long the rest takes.
class SpreadOrder {
 public:
  explicit SpreadOrder(size_t count)
      // Multiples of the golden section are spread evenly; without a common factor all come once.
      : count_(count), step_(std::max<uint64_t>(1, uint64_t(0.6180339887 * double(count)))) {
    while (count_ > 1 && std::gcd(step_, count_) > 1) ++step_;
  }
  size_t operator()(size_t number) const { return size_t(uint64_t(number) * step_ % count_); }

 private:
  uint64_t count_, step_;
};

/// Hands the team's numbers on to the threads of one member. Thread-safe.
class PieceQueue {
 public:
  PieceQueue(Team& team, size_t count)
      : team_(team),
        count_(count),
        at_a_time_(std::clamp<uint64_t>(count / (team.size() * kTimesEach), 1, kMostAtATime)) {}

  /// None: all pieces are taken.
  std::optional<size_t> next() {
    const std::lock_guard lock(mutex_);
    if (next_ == end_ && next_ < count_) {
      next_ = team_.next(at_a_time_);
      end_ = next_ < count_ ? std::min<uint64_t>(next_ + at_a_time_, count_) : next_;
    }
    if (next_ >= count_) return std::nullopt;
    return size_t(next_++);
  }

 private:
  Team& team_;
  const uint64_t count_, at_a_time_;
  std::mutex mutex_;
  uint64_t next_ = 0, end_ = 0;
};

/// Adds the units that all members do of a stage to the first one's progress. Thread-safe.
class DoneOfTeam {
 public:
  DoneOfTeam(Team& team, Progress& progress)
      : team_(team), progress_(progress), told_(done_here()) {}

  /// Called now and then.
  void pass_on() {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock) pass_on_locked();
  }
  void pass_on_rest() {
    const std::lock_guard lock(mutex_);
    pass_on_locked();
  }

 private:
  Team::Done done_here() const {
    const Progress::Snapshot now = progress_.snapshot();
    return {now.done, now.skipped};
  }
  void pass_on_locked() {
    if (team_.rank() == 0) {
      const Team::Done others = team_.told();
      progress_.skip(others.skipped), progress_.advance(others.units - others.skipped);
      return;
    }
    const Team::Done now = done_here();
    if (now.units == told_.units) return;
    team_.tell({now.units - told_.units, now.skipped - told_.skipped});
    told_ = now;
  }

  Team& team_;
  Progress& progress_;
  std::mutex mutex_;
  Team::Done told_;
};

/// One message of pieces: a byte that says whether more follow, then number and content of each.
struct Outgoing {
  std::span<const uint32_t> own;
  const PieceExchange& pieces;
  size_t most_bytes = 0, next = 0;

  ByteWriter message() {
    ByteWriter out;
    out.put_value(uint8_t(0));
    while (next < own.size() && out.bytes.size() < most_bytes) {
      out.put_value(own[next]);
      pieces.put(own[next++], out);
    }
    out.bytes[0] = std::byte(next < own.size());
    return out;
  }
};

/// Returns whether more follow.
Result<bool> take_message(uint32_t rank, std::span<const std::byte> bytes,
                          const PieceExchange& pieces) {
  ByteReader in{bytes};
  const bool more = in.get_value<uint8_t>() != 0;
  while (in.ok && !in.bytes.empty()) {
    const uint32_t piece = in.get_value<uint32_t>();
    in.ok = in.ok && piece < pieces.count && pieces.take(piece, rank, in) && in.ok;
  }
  if (!in.ok) return fail(ErrorCode::io, "process {} has sent incomplete data", rank);
  return more;
}

}  // namespace

Result<std::vector<uint32_t>> share_out(Team* team, size_t count, Progress& progress,
                                        const std::function<void(size_t)>& work) {
  std::vector<uint8_t> is_own(count, team ? 0 : 1);
  if (!team) {
    const SpreadOrder order(count);
    parallel_for(count, 1, [&](size_t number, size_t) {
      if (!progress.cancelled()) work(order(number));
    });
  } else {
    DoneOfTeam done(*team, progress);
    LUXEL_TRY_STATUS(team->begin_stage(progress));
    PieceQueue queue(*team, count);
    parallel_for(count, 1, [&](size_t, size_t) {
      if (progress.cancelled()) return;
      const std::optional<size_t> piece = queue.next();
      if (!piece) return;
      is_own[*piece] = 1;
      work(*piece);
      done.pass_on();
    });
    done.pass_on_rest();
  }
  LUXEL_TRY_STATUS(stopped(progress));
  std::vector<uint32_t> own;
  for (uint32_t piece = 0; piece < count; ++piece)
    if (is_own[piece]) own.push_back(piece);
  return own;
}

Result<std::vector<uint32_t>> share_out_in_turn(Team* team, size_t count, Progress& progress,
                                                const std::function<void(size_t)>& work) {
  std::vector<uint32_t> own;
  std::optional<DoneOfTeam> done;
  if (team) {
    done.emplace(*team, progress);
    LUXEL_TRY_STATUS(team->begin_stage(progress));
  }
  for (size_t piece = 0;; ++piece) {
    if (team) piece = size_t(std::min<uint64_t>(team->next(1), count));
    LUXEL_TRY_STATUS(stopped(progress));
    if (piece >= count) break;
    own.push_back(uint32_t(piece));
    work(piece);
    if (done) done->pass_on();
  }
  if (done) done->pass_on_rest();
  return own;
}

Status do_own(Team* team, std::span<const uint32_t> own, Progress& progress,
              const std::function<void(size_t)>& work) {
  std::optional<DoneOfTeam> done;
  if (team) {
    done.emplace(*team, progress);
    LUXEL_TRY_STATUS(team->begin_stage(progress));
  }
  parallel_for(own.size(), 1, [&](size_t k, size_t) {
    if (progress.cancelled()) return;
    work(own[k]);
    if (done) done->pass_on();
  });
  if (done) done->pass_on_rest();
  return stopped(progress);
}

Result<uint64_t> keep_in_shares(
    Team* team, std::vector<uint32_t>& which, Progress& progress,
    const std::function<Result<uint64_t>(std::vector<uint32_t>&)>& keep) {
  if (!team) return keep(which);
  const auto first_of = [&](size_t rank) {
    return which.begin() + std::ptrdiff_t(which.size() * rank / team->size());
  };
  std::vector<uint32_t> some(first_of(team->rank()), first_of(team->rank() + 1));
  LUXEL_TRY(const uint64_t rays, keep(some));
  ByteWriter out;
  out.put_value(rays), out.put(std::span<const uint32_t>(some));
  LUXEL_TRY(const auto all, team->all_gather(out.bytes, progress));
  which.clear();
  uint64_t sum = 0;
  for (const std::vector<std::byte>& bytes : all) {
    ByteReader in{bytes};
    sum += in.get_value<uint64_t>();
    some.resize(in.bytes.size() / sizeof(uint32_t));
    in.get(std::span(some));
    which.insert(which.end(), some.begin(), some.end());
  }
  return sum;
}

Status exchange(Team* team, std::span<const uint32_t> own, const PieceExchange& pieces,
                Progress& progress) {
  if (!team) return {};
  Outgoing outgoing{own, pieces, kTeamBytesAtATime / team->size()};
  for (bool more = true; more;) {
    const ByteWriter out = outgoing.message();
    LUXEL_TRY(const auto all, team->all_gather(out.bytes, progress));
    more = false;
    for (uint32_t rank = 0; rank < all.size(); ++rank) {
      if (rank == team->rank()) {
        more = more || out.bytes[0] != std::byte{0};
        continue;
      }
      LUXEL_TRY(const bool its_more, take_message(rank, all[rank], pieces));
      more = more || its_more;
    }
  }
  return {};
}

Result<uint64_t> sum_of_members(Team* team, uint64_t own, Progress& progress) {
  if (!team) return own;
  ByteWriter out;
  out.put_value(own);
  LUXEL_TRY(const auto all, team->all_gather(out.bytes, progress));
  uint64_t sum = 0;
  for (const std::vector<std::byte>& bytes : all) sum += ByteReader{bytes}.get_value<uint64_t>();
  return sum;
}

bool is_first(const Team* team) { return !team || team->rank() == 0; }

Status leave_rest_to_first(const Team* team) {
  if (!team || team->rank() == 0) return {};
  return fail(ErrorCode::parts_missing, "the rest is the work of process 0");
}

}  // namespace base
}  // namespace luxel
