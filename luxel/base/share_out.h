// The pieces of a stage, shared out among the members of a team.
#pragma once

#include <cstdint>
#include <functional>
#include <type_traits>
#include <vector>

#include "luxel/base/bytes.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"

namespace luxel {
inline namespace base {

/// Calls work(piece) for pieces 0 .. count - 1, each at one member of the team, on several threads
/// of each. Members take pieces as they are ready for more, so that slower ones do less. Returns
/// those of this member, ascending; when the work is cancelled, some are done by nobody. Units of
/// `progress` are those of the whole stage, whose first member sees what all do. Without a team all
/// pieces are this process's. Errors: cancelled, another member gives up.
Result<std::vector<uint32_t>> share_out(Team* team, size_t count, Progress& progress,
                                        const std::function<void(size_t piece)>& work);

/// Does the same for pieces whose member is known: calls work(piece) for each of `own`.
Status do_own(Team* team, std::span<const uint32_t> own, Progress& progress,
              const std::function<void(size_t piece)>& work);

/// What a member knows of a piece, and what it hears of the others' pieces.
struct PieceExchange {
  size_t count = 0;  ///< of all pieces
  std::function<void(size_t piece, ByteWriter& out)> put;
  /// Returns whether `in` has what it should. `rank`: whose piece it is.
  std::function<bool(size_t piece, uint32_t rank, ByteReader& in)> take;
};
/// Gives what this member's `own` pieces are to all others, and takes theirs, in any order, one at
/// a time. Nothing happens without a team. Errors: cancelled, another member gives up, what a
/// member has sent does not end where it should.
Status exchange(Team* team, std::span<const uint32_t> own, const PieceExchange& pieces,
                Progress& progress);

/// Calls keep(some) on one of as many equal parts of `which` as there are members, which drops
/// numbers from it and returns how many rays that took. `which` becomes what is left of all parts,
/// in order. Returns the sum of rays. Errors: those of keep, another member gives up, cancelled.
Result<uint64_t> keep_in_shares(
    Team* team, std::vector<uint32_t>& which, Progress& progress,
    const std::function<Result<uint64_t>(std::vector<uint32_t>& some)>& keep);

/// A value as the first member has it, where members may differ: by the clock, say. Errors:
/// cancelled, another member gives up.
template <class T>
requires std::is_trivially_copyable_v<T> Result<T> first_of(Team* team, T value,
                                                            Progress& progress) {
  if (!team) return value;
  ByteWriter out;
  if (team->rank() == 0) out.put_value(value);
  LUXEL_TRY(const auto all, team->all_gather(out.bytes, progress));
  return ByteReader{all.front()}.template get_value<T>();
}

}  // namespace base
}  // namespace luxel
