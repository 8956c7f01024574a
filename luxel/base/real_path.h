// Where a path leads, for files that may be opened only below a folder.
#pragma once

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace luxel {
inline namespace base {

/// The path with every symbolic link followed; that of an empty one is the process's folder. Empty
/// where there is nothing.
inline std::filesystem::path real_path(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::path real =
      std::filesystem::canonical(path.empty() ? std::filesystem::path(".") : path, failed);
  return failed ? std::filesystem::path() : real;
}

/// True where `file`, a real_path(), lies below a folder, which may be any path.
inline bool lies_below(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const std::filesystem::path real = real_path(folder);
  const auto [in_folder, in_file] =
      std::mismatch(real.begin(), real.end(), file.begin(), file.end());
  return !real.empty() && in_folder == real.end() && in_file != file.end();
}

}  // namespace base
}  // namespace luxel
