// Whether what is shown has become otherwise on disk.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace luxel::view {

/// A file as a folder knows it; without anything where it is not there.
struct FileState {
  std::filesystem::file_time_type time{};
  uintmax_t size = 0;
  friend bool operator==(const FileState&, const FileState&) = default;
};

/// The files of one scene, one .lxr file or one folder of a bake.
struct FileWatch {
  std::vector<std::filesystem::path> files;
  std::vector<FileState> known;                ///< when it was opened
  std::optional<std::vector<FileState>> seen;  ///< by the last look, where it was another
};

/// What it is now is known. Of a folder the files of a bake are watched that a window reads.
FileWatch watch_file(const std::filesystem::path& subject);

/// To be called now and then. True, once, when the files are others than was known, all are there,
/// and the last look found the same: nobody is writing them any longer.
bool has_changed(FileWatch& watch);

}  // namespace luxel::view
