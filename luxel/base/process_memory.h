// How much memory the process has, had, and may have.
#pragma once

#include <cstdint>

namespace luxel {

uint64_t resident_bytes();       ///< now
uint64_t resident_file_bytes();  ///< of those, pages of files that are mapped
uint64_t peak_resident_bytes();  ///< since the process started
uint64_t available_bytes();      ///< what the machine can still give without swapping
/// Hands back what the allocator has kept of freed memory.
void return_free_memory();

}  // namespace luxel
