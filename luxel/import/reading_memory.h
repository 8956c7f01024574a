// How much memory reading a scene may take.
#pragma once

#include <cstdint>
#include <string_view>

#include "luxel/base/result.h"

namespace luxel::import {

/// Counts what a file's parts will need before they are made, so that a small file cannot ask for
/// more than there is.
class ReadingMemory {
 public:
  /// `max_bytes`: for the whole process, with what it has already; 0: what the machine has free. A
  /// scene that needs less than 64 MiB is read in any case: only then can it be told which limit
  /// would do for the work.
  explicit ReadingMemory(uint64_t max_bytes);

  /// Takes `bytes` for `what`, which the message names. Errors: out_of_memory.
  Status take(uint64_t bytes, std::string_view what);

 private:
  uint64_t left_bytes_ = 0, max_bytes_ = 0;
};

}  // namespace luxel::import
