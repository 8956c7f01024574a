#include "luxel/base/scratch_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "luxel/base/file.h"
#include "luxel/base/transfer.h"

namespace luxel {

ScratchFile::ScratchFile(std::filesystem::path folder, int file)
    : folder_(std::move(folder)), file_(file) {}
ScratchFile::ScratchFile(ScratchFile&& other) noexcept
    : folder_(std::move(other.folder_)), file_(std::exchange(other.file_, -1)) {}
ScratchFile& ScratchFile::operator=(ScratchFile&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(file_, other.file_);
  return *this;
}
ScratchFile::~ScratchFile() {
  if (file_ >= 0) ::close(file_);
}

Result<ScratchFile> ScratchFile::create(const std::filesystem::path& folder) {
  const std::filesystem::path where = folder.empty() ? "." : folder;
  // O_TMPFILE needs a file system that supports it; a name that is removed at once does not.
  std::string name = (where / "luxel-scratch-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0)
    return fail(ErrorCode::io, "cannot make a temporary file in {}: {}", where.string(),
                std::strerror(errno));
  ::unlink(name.c_str());
  return ScratchFile(where, file);
}

Status ScratchFile::write(uint64_t offset, const void* bytes, size_t count) const {
  const int error =
      transfer_all(::pwrite, file_, static_cast<const char*>(bytes), count, off_t(offset));
  if (error == 0) return {};
  return fail(code_of_write(error),
              "cannot write temporary data to {}: {}; give more --max-memory or a folder with more "
              "room",
              folder_.string(), std::strerror(error));
}

Status ScratchFile::read(uint64_t offset, void* bytes, size_t count) const {
  const int error = transfer_all(::pread, file_, static_cast<char*>(bytes), count, off_t(offset));
  if (error == 0) return {};
  return fail(ErrorCode::io, "cannot read temporary data back from {}: {}", folder_.string(),
              std::strerror(error));
}

Status ScratchFile::reserve(uint64_t bytes) const {
  int error = EINTR;
  while (error == EINTR) error = ::posix_fallocate(file_, 0, off_t(bytes));
  if (error == 0) return {};
  return fail(code_of_write(error),
              "cannot make a temporary file of {}M in {}: {}; give more --max-memory or a folder "
              "with more room",
              (bytes >> 20) + 1, folder_.string(), std::strerror(error));
}

Result<void*> ScratchFile::map(uint64_t bytes) const {
  void* const begin = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
  if (begin != MAP_FAILED) return begin;
  return fail(ErrorCode::out_of_memory, "cannot map a temporary file of {}M in {}: {}",
              (bytes >> 20) + 1, folder_.string(), std::strerror(errno));
}

}  // namespace luxel
