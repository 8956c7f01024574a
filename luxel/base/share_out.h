// The pieces of a stage, shared out among the members of a team.
#pragma once

#include <algorithm>
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
/// `progress` are those of the whole stage, whose first member sees what all do. With a team,
/// something that all wait for must follow before the next stage: exchange(), mostly. Without one
/// all pieces are this process's. Errors: cancelled, another member gives up.
Result<std::vector<uint32_t>> share_out(Team* team, size_t count, Progress& progress,
                                        const std::function<void(size_t piece)>& work);

/// share_out() one piece after the other at each member: for pieces that use all threads
/// themselves.
Result<std::vector<uint32_t>> share_out_in_turn(Team* team, size_t count, Progress& progress,
                                                const std::function<void(size_t piece)>& work);

/// share_out() of pieces whose member is known: calls work(piece) for each of `own`.
Status do_own(Team* team, std::span<const uint32_t> own, Progress& progress,
              const std::function<void(size_t piece)>& work);

/// Functions that write a member's own pieces, and read the others' pieces.
struct PieceExchange {
  size_t count = 0;  ///< of all pieces
  std::function<void(size_t piece, ByteWriter& out)> put;
  /// Returns whether `in` has what it should. `rank`: whose piece it is.
  std::function<bool(size_t piece, uint32_t rank, ByteReader& in)> take;
};
/// Gives the contents of this member's `own` pieces to all others, and takes theirs, in any order,
/// one at a time. Nothing happens without a team. Errors: cancelled, another member gives up, data
/// of a member do not end where they should.
Status exchange(Team* team, std::span<const uint32_t> own, const PieceExchange& pieces,
                Progress& progress);

/// Calls work(begin, end) on ranges that cover [0, count), each `grain` long but the last one, at
/// one member of the team each. It sets `values` there, which have one entry each per number: all
/// members get all of them. Errors: those of exchange().
template <class... T>
Status share_ranges(Team* team, size_t count, size_t grain, Progress& progress,
                    const std::function<void(size_t begin, size_t end)>& work,
                    std::span<T>... values) {
  const size_t pieces = (count + grain - 1) / grain;
  const auto end_of = [=](size_t piece) { return std::min((piece + 1) * grain, count); };
  LUXEL_TRY(const std::vector<uint32_t> own, share_out(team, pieces, progress, [&](size_t piece) {
              work(piece * grain, end_of(piece));
            }));
  const auto for_each = [&](size_t piece, const auto& visit) {
    [[maybe_unused]] const size_t begin = piece * grain;  // unused where there are no values
    (visit(values.subspan(begin, end_of(piece) - begin)), ...);
  };
  return exchange(team, own,
                  {pieces,
                   [&](size_t piece, ByteWriter& out) {
                     for_each(piece, [&](auto part) { out.put(std::as_bytes(part)); });
                   },
                   [&](size_t piece, uint32_t, ByteReader& in) {
                     for_each(piece, [&](auto part) { in.get(std::as_writable_bytes(part)); });
                     return in.ok;
                   }},
                  progress);
}

/// share_ranges() of lists of any length: work(begin, end) returns one. Returns them all,
/// one after the other in the order of ranges.
template <class T>
Result<std::vector<T>> share_lists(
    Team* team, size_t count, size_t grain, Progress& progress,
    const std::function<std::vector<T>(size_t begin, size_t end)>& work) {
  std::vector<std::vector<T>> found((count + grain - 1) / grain);
  LUXEL_TRY(const std::vector<uint32_t> own,
            share_out(team, found.size(), progress, [&](size_t piece) {
              found[piece] = work(piece * grain, std::min((piece + 1) * grain, count));
            }));
  LUXEL_TRY_STATUS(exchange(team, own,
                            {found.size(),
                             [&](size_t piece, ByteWriter& out) {
                               out.put_value(uint64_t(found[piece].size()));
                               out.put(std::span<const T>(found[piece]));
                             },
                             [&](size_t piece, uint32_t, ByteReader& in) {
                               const uint64_t size = in.get_value<uint64_t>();
                               if (size > in.bytes.size() / sizeof(T)) return false;
                               found[piece].resize(size);
                               in.get(std::span<T>(found[piece]));
                               return in.ok;
                             }},
                            progress));
  std::vector<T> all;
  for (const std::vector<T>& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

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

/// The sum of a number over all members. Errors: cancelled, another member gives up.
Result<uint64_t> sum_of_members(Team* team, uint64_t own, Progress& progress);

/// True for a team's first member, and for a process that works alone.
bool is_first(const Team* team);
/// Errors (parts_missing): this is a team's member, and not its first, who does the rest.
Status leave_rest_to_first(const Team* team);

/// Tells the other members of a team when work has failed. Returns `done`.
template <class T>
Result<T> or_give_up(Team* team, Result<T> done) {
  if (!done && team) team->give_up(done.error());
  return done;
}

}  // namespace base
}  // namespace luxel
