#include "luxel/base/file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "luxel/base/transfer.h"

namespace luxel {
inline namespace base {
namespace {

Failure write_error(const std::filesystem::path& path, int error) {
  return fail(code_of_write(error), "cannot write {}: {}", path.string(), std::strerror(error));
}

/// Returns 0 or the errno of the first call that failed.
int write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    bytes = bytes.subspan(size_t(n));
  }
  return ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
}

/// Closes the file with this object.
struct OpenFile {
  int number = -1;
  explicit OpenFile(int file) : number(file) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (number >= 0) ::close(number);
  }
};

/// A file that is removed with this object unless its name was cleared.
struct TemporaryFile {
  std::string name;
  TemporaryFile() = default;
  TemporaryFile(TemporaryFile&& other) noexcept : name(std::exchange(other.name, {})) {}
  TemporaryFile& operator=(TemporaryFile&&) = delete;
  ~TemporaryFile() {
    if (!name.empty()) ::unlink(name.c_str());
  }
};

constexpr std::string_view kPartial = ".partial-", kReplaced = ".replaced-";

std::string temporary_name(const std::filesystem::path& path, std::string_view mark) {
  return path.string() + std::string(mark) + std::to_string(::getpid());
}

/// The name of the file that a temporary was to become; empty when it is none, or its process still
/// lives.
std::string left_over_of(const std::string& name) {
  for (const std::string_view mark : {kPartial, kReplaced}) {
    const size_t at = name.rfind(mark);
    if (at == name.npos) continue;
    pid_t process = 0;
    const char* end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(name.data() + at + mark.size(), end, process);
    if (error == std::errc() && stop == end && process > 0 && ::kill(process, 0) != 0 &&
        errno == ESRCH)
      return name.substr(0, at);
  }
  return {};
}

/// Removes what processes that were killed left beside these files. What cannot be removed stays.
void remove_left_overs(std::span<const std::filesystem::path> files) {
  std::map<std::filesystem::path, std::set<std::string>> names_in;
  for (const std::filesystem::path& file : files)
    names_in[file.has_parent_path() ? file.parent_path() : "."].insert(file.filename());
  for (const auto& [folder, names] : names_in) {
    std::error_code error;
    std::filesystem::directory_iterator entry(folder, error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
      if (const std::string name = left_over_of(entry->path().filename());
          !name.empty() && names.contains(name))
        ::unlink(entry->path().c_str());
  }
}

Result<TemporaryFile> write_temporary(const std::filesystem::path& path,
                                      std::span<const std::byte> bytes) {
  if (!path.has_filename())
    return fail(ErrorCode::io, "cannot write '{}': it names no file", path.string());
  // Renaming onto a folder would fail too, but after the files before this one got their names.
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return fail(ErrorCode::io, "cannot write {}: a folder of this name is in the way",
                path.string());
  TemporaryFile temporary;
  temporary.name = temporary_name(path, kPartial);
  // A link of that name would lead elsewhere.
  const int file =
      ::open(temporary.name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file < 0) return write_error(path, errno);
  int error = write_all(file, bytes);
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) return write_error(path, error);
  return temporary;
}

/// A second name for the file under `path`, if there is one, so that it can be brought back; where
/// a file system knows no second names the file gives up its first. Returns 0 or an errno.
int keep_old(const std::filesystem::path& path, TemporaryFile& old) {
  std::string name = temporary_name(path, kReplaced);
  if (::link(path.c_str(), name.c_str()) != 0) {
    if (errno == ENOENT) return 0;
    if (::rename(path.c_str(), name.c_str()) != 0) return errno;
  }
  old.name = std::move(name);
  return 0;
}

/// Undoes a rename onto `path`. Of two names of one file rename() leaves both: the name of `old` is
/// not cleared, so that it is removed in any case.
void bring_back(const std::filesystem::path& path, const TemporaryFile& old) {
  if (old.name.empty())
    ::unlink(path.c_str());
  else
    ::rename(old.name.c_str(), path.c_str());
}

}  // namespace

ErrorCode code_of_write(int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return full ? ErrorCode::out_of_disk : ErrorCode::io;
}

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path) {
  const auto error = [&](int number) {
    return fail(ErrorCode::io, "cannot read {}: {}", path.string(), std::strerror(number));
  };
  // Without O_NONBLOCK a pipe would be waited for until somebody writes to it.
  const OpenFile file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.number < 0 && errno == ENOENT)
    return fail(ErrorCode::io, "{}: no such file", path.string());
  if (file.number < 0) return error(errno);
  struct stat about {};
  if (::fstat(file.number, &about) != 0) return error(errno);
  if (S_ISDIR(about.st_mode))
    return fail(ErrorCode::io, "{} is a folder, not a file", path.string());
  if (!S_ISREG(about.st_mode))
    return fail(ErrorCode::io, "{} is a pipe or a device; only files on a disk can be read",
                path.string());
  std::vector<std::byte> bytes(size_t(about.st_size));
  if (const int number = transfer_all(::pread, file.number, bytes.data(), bytes.size(), 0))
    return error(number);
  return bytes;
}

OutputFile text_file(std::filesystem::path path, std::string_view text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {std::move(path), {begin, begin + text.size()}};
}

Status write_files_atomically(std::span<const OutputFile> files) {
  std::vector<std::filesystem::path> paths;
  for (const OutputFile& file : files) paths.push_back(file.path);
  remove_left_overs(paths);
  std::vector<TemporaryFile> temporaries;
  for (const OutputFile& file : files) {
    LUXEL_TRY(TemporaryFile temporary, write_temporary(file.path, file.bytes));
    temporaries.push_back(std::move(temporary));
  }
  std::vector<TemporaryFile> old(files.size());
  for (size_t i = 0; i < files.size(); ++i) {
    int error = keep_old(files[i].path, old[i]);
    if (error == 0 && ::rename(temporaries[i].name.c_str(), files[i].path.c_str()) != 0)
      error = errno;
    if (error != 0) {
      if (!old[i].name.empty()) bring_back(files[i].path, old[i]);
      for (size_t k = 0; k < i; ++k) bring_back(files[k].path, old[k]);
      return write_error(files[i].path, error);
    }
    temporaries[i].name.clear();
  }
  return {};
}

Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  remove_left_overs({&path, 1});
  LUXEL_TRY(TemporaryFile temporary, write_temporary(path, bytes));
  if (::rename(temporary.name.c_str(), path.c_str()) != 0) return write_error(path, errno);
  temporary.name.clear();
  return {};
}

}  // namespace base
}  // namespace luxel
