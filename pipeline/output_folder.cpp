#include "pipeline/output_folder.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/file.h"

namespace luxel::pipeline {
namespace {

namespace fs = std::filesystem;

bool exists_at(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

fs::path absolute_path(const fs::path& path) {
  std::error_code ignored;
  return fs::absolute(path, ignored).lexically_normal();
}

}  // namespace

fs::path nearest_folder(const fs::path& folder) {
  fs::path path = absolute_path(folder);
  while (!path.empty() && !exists_at(path)) path = path.parent_path();
  return path;
}

Status OutputFolder::make() {
  if (folder_.empty()) return fail(ErrorCode::bad_setting, "--output names no folder");
  const fs::path there = nearest_folder(folder_);
  for (fs::path p = absolute_path(folder_); p != there && !p.empty(); p = p.parent_path())
    made_.push_back(p);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_, error)) {
    std::error_code ignored;
    const bool in_the_way = !fs::is_directory(there, ignored);
    return fail(error == std::errc::no_space_on_device ? ErrorCode::out_of_disk : ErrorCode::io,
                "cannot make the output folder {}: {}", folder_.string(),
                in_the_way ? there.string() + " is a file; choose another name" : error.message());
  }
  return {};
}

Status OutputFolder::try_out() {
  Status done = make();
  if (done && ::access(folder_.c_str(), W_OK | X_OK) != 0)
    done = fail(ErrorCode::io, "cannot write into the output folder {}: {}", folder_.string(),
                std::strerror(errno));
  const fs::path probe = folder_ / ".luxel-can-write";
  if (done) done = write_file_atomically(probe, {});
  std::error_code ignored;
  if (done) fs::remove(probe, ignored);
  remove_made();
  return done;
}

void OutputFolder::remove_made() {
  std::error_code ignored;
  for (const fs::path& path : made_) fs::remove(path, ignored);  // an empty folder, or nothing
  made_.clear();
}

}  // namespace luxel::pipeline
