// Processes that do one piece of work together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel {
inline namespace base {

/// The members of a team run the same program on the same data, and decide the same. Each piece of
/// a long stage is done by one of them, who gives it to the others (share_out.h). What only one of
/// them can know, such as the time, the first decides for all (first_of).
///
/// begin_stage() and all_gather() return when all members have called them, in the same order. They
/// fail for all when one member gives up, and for a member whose `progress` is cancelled.
class Team {
 public:
  virtual ~Team() = default;

  virtual uint32_t rank() const = 0;  ///< of this member, below size()
  virtual uint32_t size() const = 0;

  /// Begins a stage: next() counts from 0 again.
  virtual Status begin_stage(Progress& progress) = 0;
  /// The first of the next `count` numbers of a counter that all members share. Large once a member
  /// has given up. Thread-safe.
  virtual uint64_t next(uint64_t count) = 0;
  /// Every member's bytes, by rank.
  virtual Result<std::vector<std::vector<std::byte>>> all_gather(std::span<const std::byte> own,
                                                                 Progress& progress) = 0;
  /// Units of a stage's progress, and those of them that were there already.
  struct Done {
    uint64_t units = 0, skipped = 0;
  };
  /// Tells the first member what this one has done since the last call. Thread-safe.
  virtual void tell(Done done) = 0;
  /// At the first member: what the others have told since the last call. Thread-safe.
  virtual Done told() = 0;

  /// Traffic of all members so far: calls of all_gather(), and their bytes.
  struct Gathered {
    uint64_t times = 0, bytes = 0;
  };
  virtual Gathered gathered() const = 0;

  /// This member cannot go on: the others get `error`, with its rank and where it runs.
  virtual void give_up(const Error& error) = 0;
};

/// The bytes that all members together send at a time, about.
inline constexpr size_t kTeamBytesAtATime = size_t(64) << 20;

}  // namespace base
}  // namespace luxel
