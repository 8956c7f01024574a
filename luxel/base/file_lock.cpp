#include "luxel/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace luxel {
inline namespace base {

Result<FileLock> FileLock::take(const std::filesystem::path& path, const std::string& what) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0)
    return fail(ErrorCode::io, "cannot write {}: {}", path.string(), std::strerror(errno));
  if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(file);
    return fail(ErrorCode::bad_setting, "another process is at work on {}; wait until it has ended",
                what);
  }
  return FileLock(path, file);
}

FileLock::~FileLock() {
  if (file_ < 0) return;
  // Before it is given up: whoever takes the name next makes a file of its own.
  ::unlink(path_.c_str());
  ::close(file_);
}

}  // namespace base
}  // namespace luxel
