#include "luxel/import/reading_memory.h"

#include <algorithm>

#include "luxel/base/file.h"

namespace luxel::import {
namespace {

constexpr double kMiB = 1024 * 1024;

uint64_t bytes_beside_held(uint64_t max_bytes) {
  constexpr uint64_t kLeast = 64 * 1024 * 1024;
  const uint64_t held = resident_bytes();
  return std::max(max_bytes == 0 ? available_bytes() : std::max(max_bytes, held) - held, kLeast);
}

}  // namespace

ReadingMemory::ReadingMemory(uint64_t max_bytes)
    : max_bytes_(max_bytes),
      first_bytes_(bytes_beside_held(max_bytes)),
      left_bytes_(first_bytes_),
      limit_(first_bytes_) {}

Status ReadingMemory::take(uint64_t bytes, std::string_view what) {
  if (bytes > left_bytes_)
    return fail(ErrorCode::out_of_memory, "{} needs {:.1f} MiB, and {:.1f} MiB are {}; {}", what,
                double(bytes) / kMiB, double(left_bytes_) / kMiB, where_from(), remedy());
  left_bytes_ -= bytes;
  return {};
}

Failure ReadingMemory::used_up(std::string_view what) const {
  return fail(ErrorCode::out_of_memory, "{} needs more than the {:.1f} MiB that are {}; {}", what,
              double(first_bytes_) / kMiB, where_from(), remedy());
}

const char* ReadingMemory::where_from() const {
  return max_bytes_ == 0 ? "free" : "left of --max-memory";
}
const char* ReadingMemory::remedy() const {
  return max_bytes_ == 0 ? "use smaller pictures or fewer triangles, or a larger machine"
                         : "raise it, or use smaller pictures or fewer triangles";
}

bool says_no_memory(const Error& error) {
  return error.message.find("bad_alloc") != std::string::npos;
}

Result<std::vector<std::byte>> read_counted(const std::filesystem::path& file,
                                            ReadingMemory& memory) {
  std::error_code unknown;  // read_file() says so
  const uintmax_t size = std::filesystem::file_size(file, unknown);
  if (!unknown) LUXEL_TRY_STATUS(memory.take(size, file.string()));
  return read_file(file);
}

}  // namespace luxel::import
