#include "luxel/view/model/file_watch.h"

#include <algorithm>
#include <utility>

namespace luxel::view {
namespace {

FileState state_of(const std::filesystem::path& file) {
  std::error_code error;
  FileState out;
  out.size = std::filesystem::file_size(file, error);
  if (error) return {};
  out.time = std::filesystem::last_write_time(file, error);
  return error ? FileState{} : out;
}

std::vector<FileState> states_of(const FileWatch& watch) {
  std::vector<FileState> out;
  for (const std::filesystem::path& file : watch.files) out.push_back(state_of(file));
  return out;
}

}  // namespace

FileWatch watch_file(const std::filesystem::path& subject) {
  FileWatch out;
  std::error_code ignored;
  if (std::filesystem::is_directory(subject, ignored))
    for (const char* file : {"baked.glb", "lightmap.exr", "bake.json"})
      out.files.push_back(subject / file);
  else
    out.files.push_back(subject);
  out.known = states_of(out);
  return out;
}

bool has_changed(FileWatch& watch) {
  std::vector<FileState> now = states_of(watch);
  if (now == watch.known) return watch.seen.reset(), false;
  // Bakes of several pages have no lightmap.exr.
  bool is_gone = false;
  for (size_t i = 0; i < now.size(); ++i)
    is_gone |= now[i] == FileState{} && watch.known[i] != FileState{};
  const bool is_same = watch.seen == now;
  watch.seen = now;
  if (is_gone || !is_same) return false;
  watch.known = std::move(now), watch.seen.reset();
  return true;
}

}  // namespace luxel::view
