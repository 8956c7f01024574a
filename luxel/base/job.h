// A stage of long work in parts: each is found where an earlier run has kept it, left to others, or
// done, kept and given to a team.
#pragma once

#include <cstdint>
#include <functional>

#include "luxel/base/bytes.h"
#include "luxel/base/part_store.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"

namespace luxel {
inline namespace base {

/// The surroundings of a stage: where its parts are kept, and whose members share them out.
struct Job {
  Progress& progress;
  KeptStage kept{};
  Team* team = nullptr;
};

/// A stage: what it does for part number k, and how that becomes bytes.
struct PartWork {
  size_t count = 0;                                ///< parts
  std::function<uint64_t(size_t k)> units;         ///< of progress
  std::function<uint64_t(size_t k)> compute;       ///< returns the rays that it took
  std::function<void(size_t k, ByteWriter&)> put;  ///< what compute() has found
  /// False, and nothing is changed: the bytes are not those of such a part.
  std::function<bool(size_t k, ByteReader&)> get;
};

/// Returns the rays of all parts. Errors: cancelled, another member of the team gives up.
Result<uint64_t> for_each_part(const Job& job, const PartWork& work);
/// Keeps a part that has been done in another way, such as by a device.
void keep_part(const KeptStage& kept, const PartWork& work, size_t k, uint64_t rays);

}  // namespace base
}  // namespace luxel
