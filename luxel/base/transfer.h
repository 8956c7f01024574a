// The loops around pread() and pwrite(), which may move fewer bytes than they were asked for.
#pragma once

#include <sys/types.h>

#include <cerrno>
#include <cstddef>

namespace luxel {
inline namespace base {

/// Reads (::pread) or writes (::pwrite) everything at an offset; returns 0 or an errno. Where a
/// file ends early that is EIO.
template <class Call, class Byte>
int transfer_all(Call call, int file, Byte* bytes, size_t count, off_t offset) {
  while (count > 0) {
    const ssize_t n = call(file, bytes, count, offset);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    bytes += n, count -= size_t(n), offset += n;
  }
  return 0;
}

}  // namespace base
}  // namespace luxel
