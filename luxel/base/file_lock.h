// Work that only one process may do at a time.
#pragma once

#include <filesystem>
#include <utility>

#include "luxel/base/result.h"

namespace luxel {
inline namespace base {

/// True while an open file or folder is still the one of that name.
bool is_still_there(int file, const std::filesystem::path& path);

/// Holds the lock of a name until it goes, or its process does. A file of that name stands for it
/// meanwhile.
class FileLock {
 public:
  /// Errors: another process holds it (bad_setting; `what` it works on), the file cannot be made.
  /// Where a file system has no locks, nobody is kept out.
  static Result<FileLock> take(const std::filesystem::path& file, const std::string& what);
  FileLock(FileLock&& other) noexcept
      : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  FileLock(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}

  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace base
}  // namespace luxel
