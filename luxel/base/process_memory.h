// Memory that the process has, had, and may have.
#pragma once

#include <cstdint>

namespace luxel {

uint64_t resident_bytes();       ///< now
uint64_t resident_file_bytes();  ///< of those, pages of files that are mapped
uint64_t virtual_bytes();        ///< addresses that are taken now, which RLIMIT_AS limits
uint64_t peak_resident_bytes();  ///< since the process started
uint64_t available_bytes();      ///< what the machine can still give without swapping
/// Hands back what the allocator has kept of freed memory.
void return_free_memory();

/// While it lives, the process may take so many bytes more of memory of its own (RLIMIT_DATA): an
/// allocation beyond them fails, in whichever library it is. Of several that live at a time, in
/// threads, the first counts. Sanitizers map memory by themselves: with them it does nothing.
class MemoryLimit {
 public:
  explicit MemoryLimit(uint64_t more_bytes);
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  ~MemoryLimit();

 private:
  bool is_set_ = false;
  uint64_t before_ = 0;
};

}  // namespace luxel
