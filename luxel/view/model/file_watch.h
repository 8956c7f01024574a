// Watches the files of what is shown for changes on disk.
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

/// The files' present state is known. Of a bake's folder, those that a window reads are watched.
FileWatch watch_file(const std::filesystem::path& subject);

/// To be called now and then. True, once, when the files differ from the known ones, all are there,
/// and none has changed since the last look: nobody is writing them any longer.
bool has_changed(FileWatch& watch);

}  // namespace luxel::view
