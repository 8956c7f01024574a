#include "luxel/base/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "luxel/base/file.h"
#include "luxel/base/file_lock.h"

namespace luxel {
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

/// Folders, the innermost first.
void remove_if_empty(const std::vector<fs::path>& folders) {
  std::error_code ignored;
  for (const fs::path& path : folders) fs::remove(path, ignored);
}

Status try_to_write_into(const fs::path& folder) {
  const fs::path probe = folder / ".luxel-can-write";
  LUXEL_TRY_STATUS(write_file_atomically(probe, {}));
  std::error_code ignored;
  fs::remove(probe, ignored);
  return {};
}

}  // namespace

fs::path nearest_folder(const fs::path& folder) {
  fs::path path = absolute_path(folder);
  while (!path.empty() && !exists_at(path)) path = path.parent_path();
  return path;
}

Status check_output_file(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    return fail(ErrorCode::bad_setting, "--output {}: there is no folder {}; make it first",
                file.string(), folder.string());
  const fs::file_status there = fs::status(file, ignored);
  if (fs::is_directory(there))
    return fail(ErrorCode::bad_setting, "--output {} is a folder; name a file in it",
                file.string());
  if (fs::exists(there) && !fs::is_regular_file(there))
    return fail(ErrorCode::bad_setting,
                "--output {} is a device or a pipe, which would be replaced; name a file",
                file.string());
  if (const Status tried = try_to_write_into(folder); !tried)
    return fail(tried.error().code, "--output {}: {}", file.string(), tried.error().message);
  return {};
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
    return fail(code_of_write(error.value()), "cannot make the output folder {}: {}",
                folder_.string(),
                in_the_way ? there.string() + " is a file; choose another name" : error.message());
  }
  return {};
}

Status OutputFolder::try_out() {
  Status done = make();
  if (done) done = write_probe();
  remove_made();
  return done;
}

Status OutputFolder::write_probe() const {
  if (::access(folder_.c_str(), W_OK | X_OK) != 0)
    return fail(ErrorCode::io, "cannot write into the output folder {}: {}", folder_.string(),
                std::strerror(errno));
  return try_to_write_into(folder_);
}

Status OutputFolder::lock() {
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
    return {};  // not every file system has locks
  made_.clear();
  return fail(ErrorCode::bad_setting,
              "another bake is using {}; wait until it has ended, or give another --output",
              folder_.string());
}

Status OutputFolder::hold(Progress& progress) {
  // The process that held the folder before may have removed it between make() and lock().
  for (int attempt = 0;; ++attempt) {
    LUXEL_TRY_STATUS(make());
    LUXEL_TRY_STATUS(lock());
    if (lock_ < 0 || is_still_there(lock_, folder_) || attempt == 9) break;
    ::close(lock_);
  }
  progress.set_clean_up([made = made_] { remove_if_empty(made); });
  return write_probe();
}

void OutputFolder::remove_made() {
  remove_if_empty(made_);
  made_.clear();
}

OutputFolder::~OutputFolder() {
  remove_made();
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace luxel
