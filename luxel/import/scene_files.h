// Files that a scene's file names: buffers, pictures, material libraries. Scenes come from
// strangers, so what they may name is limited.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/import/reading_memory.h"

namespace luxel::import {

/// Where the files may lie that a scene's file names.
struct SceneFiles {
  /// The folder of the scene's file. None: it lies in memory and may name no file.
  std::optional<std::filesystem::path> folder;
  std::vector<std::filesystem::path> search_paths;  ///< further folders, looked into after it
  bool trust_paths = false;                         ///< anywhere
};

/// The file that a scene means by `stated`: as it stands, from the scene's folder, then from each
/// of the search paths; then its last part in each of these folders, since exporters keep the
/// places on their author's disk; then both in any case, as Windows and macOS find them.
/// "textures\brick.png" is a path from Windows. Symbolic links are followed before it is judged
/// where a file lies. `what` begins the message: "room.obj: the texture of wall". Errors (io):
/// there is none, or only outside of these folders.
Result<std::filesystem::path> find_named_file(const SceneFiles& files, std::string_view stated,
                                              std::string_view what);

/// The bytes of find_named_file(). Errors: those of it and of read_counted().
Result<std::vector<std::byte>> read_named_file(const SceneFiles& files, std::string_view stated,
                                               std::string_view what, ReadingMemory& memory);

/// A picture, which may lie in a folder named textures (in any case) too: below one of these
/// folders or beside the scene's. Errors: those of read_named_file().
Result<std::vector<std::byte>> read_named_picture(const SceneFiles& files, std::string_view stated,
                                                  std::string_view what, ReadingMemory& memory);

}  // namespace luxel::import
