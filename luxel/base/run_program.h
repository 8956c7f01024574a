// A program that runs while this one waits for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "luxel/base/result.h"

namespace luxel {
inline namespace base {

/// End of a program, and all that it wrote to its standard output and standard error.
struct ProgramEnd {
  int status = 0;           ///< as waitpid() gives it
  bool was_killed = false;  ///< because its time was over
  std::vector<std::byte> out;
  std::string err;
};

/// Runs `words[0]`, a path, with all `words` as its arguments, the environment of this process, no
/// input and no other open file. After `seconds` it is killed. It is started by posix_spawn(): a
/// process that has threads must not fork without starting another program. Thread-safe.
/// Errors: it cannot be started, or its end not waited for (io); it has written more than
/// `most_bytes` (out_of_memory).
Result<ProgramEnd> run_program(const std::vector<std::string>& words, double seconds,
                               uint64_t most_bytes);

}  // namespace base
}  // namespace luxel
