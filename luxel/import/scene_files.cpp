#include "luxel/import/scene_files.h"

#include <algorithm>

#include "luxel/base/real_path.h"
#include "luxel/base/shown_text.h"
#include "luxel/import/text_lines.h"

namespace luxel::import {
namespace {

namespace fs = std::filesystem;

bool is_allowed(const SceneFiles& files, const fs::path& file) {
  return files.trust_paths || lies_below(file, *files.folder) ||
         std::ranges::any_of(files.search_paths,
                             [&](const fs::path& folder) { return lies_below(file, folder); });
}

/// The real path of a file; empty for what is none.
fs::path real_file(const fs::path& path) {
  std::error_code ignored;
  const fs::path file = path.empty() ? path : real_path(path);
  return file.empty() || fs::is_directory(file, ignored) ? fs::path() : file;
}

/// The entry of a folder that has this name, be it in another case; the first in the alphabet where
/// there are several, whatever order the disk has. Empty: none.
fs::path entry_in_any_case(const fs::path& folder, const fs::path& name) {
  std::error_code failed;
  if (fs::exists(folder / name, failed)) return folder / name;
  const std::string wanted = lower_case(name.string());
  fs::path best;
  fs::directory_iterator at(folder, failed);
  for (; !failed && at != fs::directory_iterator(); at.increment(failed))
    if (lower_case(at->path().filename().string()) == wanted && (best.empty() || at->path() < best))
      best = at->path();
  return best;
}

/// A path below a folder, each of its parts in any case. Empty: there is none.
fs::path in_any_case(const fs::path& folder, const fs::path& relative) {
  fs::path at = folder.empty() ? fs::path(".") : folder;  // empty: the process's folder
  for (const fs::path& part : relative) {
    if (part.empty() || part.is_absolute() || part == "..") return {};
    if (part != "." && (at = entry_in_any_case(at, part)).empty()) return {};
  }
  return at;
}

std::vector<fs::path> folders_of(const SceneFiles& files) {
  std::vector<fs::path> folders{*files.folder};
  folders.insert(folders.end(), files.search_paths.begin(), files.search_paths.end());
  return folders;
}

std::string with_slashes(std::string_view stated) {
  std::string slashed(stated);
  std::ranges::replace(slashed, '\\', '/');
  return slashed;
}

/// A picture in a folder named textures, in any case, of the scene's folder, of one of the search
/// paths, or beside the scene's folder. Empty: none.
fs::path picture_in_textures(const SceneFiles& files, const fs::path& name) {
  std::vector<fs::path> folders = folders_of(files);
  folders.push_back(real_path(*files.folder).parent_path());
  for (const fs::path& folder : folders) {
    const fs::path textures = in_any_case(folder, "textures");
    const fs::path file = textures.empty() ? fs::path() : real_file(in_any_case(textures, name));
    // A link there leads no further than the folder does.
    if (!file.empty() && lies_below(file, textures) && lies_below(real_path(textures), folder))
      return file;
  }
  return {};
}

}  // namespace

Result<fs::path> find_named_file(const SceneFiles& files, std::string_view stated,
                                 std::string_view what) {
  if (!files.folder)
    return fail(ErrorCode::io, "{} is {}, but a scene in memory cannot name files", what,
                short_message(std::string(stated)));
  // A name with a backslash in it comes before the one from Windows.
  const std::string slashed = with_slashes(stated);
  const fs::path whole(slashed), last = whole.filename();
  if (last.empty()) return fail(ErrorCode::io, "{} names no file", what);
  const std::vector<fs::path> folders = folders_of(files);
  std::vector<fs::path> candidates;
  for (const fs::path& name : {fs::path(stated), whole, last})
    for (const fs::path& folder : folders) candidates.push_back(folder / name);
  bool is_outside = false;
  const auto usable = [&](const fs::path& candidate) {
    const fs::path file = real_file(candidate);
    const bool is_usable = !file.empty() && is_allowed(files, file);
    is_outside = is_outside || (!file.empty() && !is_usable);
    return is_usable ? file : fs::path();
  };
  for (const fs::path& candidate : candidates)
    if (const fs::path file = usable(candidate); !file.empty()) return file;
  for (const fs::path& name : {whole, last})
    for (const fs::path& folder : folders)
      if (const fs::path file = usable(in_any_case(folder, name)); !file.empty()) return file;
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

Result<std::vector<std::byte>> read_named_picture(const SceneFiles& files, std::string_view stated,
                                                  std::string_view what, ReadingMemory& memory) {
  const Result<fs::path> file = find_named_file(files, stated, what);
  if (file || !files.folder) return read_named_file(files, stated, what, memory);
  const fs::path other = picture_in_textures(files, fs::path(with_slashes(stated)).filename());
  if (other.empty()) return Failure{file.error()};
  return read_counted(other, memory);
}

}  // namespace luxel::import
