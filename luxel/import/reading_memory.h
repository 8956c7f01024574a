// The memory that reading a scene may take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "luxel/base/process_memory.h"
#include "luxel/base/result.h"

namespace luxel::import {

/// Counts what a file's parts will need before they are made, so that a small file cannot ask for
/// more than there is. While it lives, the kernel gives the process no more than that, whichever
/// library asks.
class ReadingMemory {
 public:
  /// `max_bytes`: for the whole process, with what it has already; 0: what the machine has free. A
  /// scene that needs less than 64 MiB is read in any case: only then can it be told which limit
  /// would do for the work.
  explicit ReadingMemory(uint64_t max_bytes);

  /// Takes `bytes` for `what`, which the message names. Errors: out_of_memory.
  Status take(uint64_t bytes, std::string_view what);
  uint64_t left_bytes() const { return left_bytes_; }
  /// The error where `what` has asked for more than there was, without saying so before.
  Failure used_up(std::string_view what) const;

 private:
  const char* where_from() const;
  const char* remedy() const;

  uint64_t max_bytes_ = 0, first_bytes_ = 0, left_bytes_ = 0;
  MemoryLimit limit_;
};

/// True where a library says in its own words that an allocation failed.
bool says_no_memory(const Error& error);

/// The bytes of a file, taken off `memory` first. Errors: those of read_file() and of take().
Result<std::vector<std::byte>> read_counted(const std::filesystem::path& file,
                                            ReadingMemory& memory);

}  // namespace luxel::import
