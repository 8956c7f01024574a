#include "luxel/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace luxel {
inline namespace base {

bool is_still_there(int file, const std::filesystem::path& path) {
  struct stat opened {
  }, named{};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

Result<FileLock> FileLock::take(const std::filesystem::path& path, const std::string& what) {
  // The process that held it before may remove the file between open and lock.
  for (int attempt = 0;; ++attempt) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (file < 0)
      return fail(ErrorCode::io, "cannot write {}: {}", path.string(), std::strerror(errno));
    if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(file);
      return fail(ErrorCode::bad_setting, "another process is using {}; wait until it has ended",
                  what);
    }
    if (is_still_there(file, path) || attempt == 9) return FileLock(path, file);
    ::close(file);
  }
}

FileLock::~FileLock() {
  if (file_ < 0) return;
  // Before it is given up: whoever takes the name next makes a file of its own.
  ::unlink(path_.c_str());
  ::close(file_);
}

}  // namespace base
}  // namespace luxel
