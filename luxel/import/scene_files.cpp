#include "luxel/import/scene_files.h"

#include <algorithm>

#include "luxel/base/real_path.h"
#include "luxel/base/short_message.h"

namespace luxel::import {
namespace {

namespace fs = std::filesystem;

bool is_allowed(const SceneFiles& files, const fs::path& file) {
  return files.trust_paths || lies_below(file, *files.folder) ||
         std::ranges::any_of(files.search_paths,
                             [&](const fs::path& folder) { return lies_below(file, folder); });
}

}  // namespace

Result<fs::path> find_named_file(const SceneFiles& files, std::string_view stated,
                                 std::string_view what) {
  if (!files.folder)
    return fail(ErrorCode::io, "{} is {}, but a scene in memory cannot name files", what,
                short_message(std::string(stated)));
  std::string slashed(stated);
  std::ranges::replace(slashed, '\\', '/');
  // A name with a backslash in it comes before the one from Windows.
  std::vector<fs::path> names{fs::path(stated), fs::path(slashed)};
  names.push_back(names.back().filename());
  std::vector<fs::path> folders{*files.folder};
  folders.insert(folders.end(), files.search_paths.begin(), files.search_paths.end());
  bool is_outside = false;
  for (const fs::path& name : names) {
    if (name.empty()) continue;
    for (const fs::path& folder : folders) {
      const fs::path file = real_path(folder / name);
      std::error_code ignored;
      if (file.empty() || fs::is_directory(file, ignored)) continue;
      if (is_allowed(files, file)) return file;
      is_outside = true;
    }
  }
  if (is_outside)
    return fail(
        ErrorCode::io,
        "{} is {}, which lies outside of the scene's folder; copy it there, name its folder "
        "with --search-path, or allow all files with --trust-paths",
        what, short_message(slashed));
  return fail(ErrorCode::io,
              "{} is {}, which is missing; put it beside the scene or name its folder with "
              "--search-path",
              what, short_message(slashed));
}

Result<std::vector<std::byte>> read_named_file(const SceneFiles& files, std::string_view stated,
                                               std::string_view what, ReadingMemory& memory) {
  LUXEL_TRY(const fs::path file, find_named_file(files, stated, what));
  return read_counted(file, memory);
}

}  // namespace luxel::import
