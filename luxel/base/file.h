// Whole files in and out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"

namespace luxel {
inline namespace base {

/// The bytes of a file. Errors (io): missing; a folder, a pipe or a device; unreadable.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

/// A file to be written: its final name and all its bytes.
struct OutputFile {
  std::filesystem::path path;
  std::vector<std::byte> bytes;
};

/// The code of a write that failed with this errno: out_of_disk where the disk, the user's part of
/// it, or the size that a file may have (ulimit -f) is used up; otherwise io.
ErrorCode code_of_write(int error);

/// A file of text.
OutputFile text_file(std::filesystem::path path, std::string_view text);

/// Writes files that appear whole under their names, all of them or none: temporary neighbours are
/// written and flushed to the disk, and only when the last one is safe are they renamed. When a
/// rename fails, what the ones before it replaced is brought back.
/// Errors: unwritable folder (io), full disk (out_of_disk); the temporaries are removed. Those that
/// a kill left go when the same files are written again.
Status write_files_atomically(std::span<const OutputFile> files);
/// write_files_atomically() of one file.
Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace base
}  // namespace luxel
