#include "luxel/base/record_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "luxel/base/digest.h"
#include "luxel/base/file.h"
#include "luxel/base/transfer.h"

namespace luxel {
inline namespace base {
namespace {

/// The number is that of the format; the line's end shows what a transfer as text has done.
constexpr std::array<char, 16> kMagic{'l', 'u', 'x', 'e', 'l', ' ', 'r',  'e',
                                      'c', 'o', 'r', 'd', 's', '2', '\r', '\n'};

struct FileStart {
  std::array<char, 16> magic = kMagic;
  uint64_t header_bytes = 0;
  uint64_t header_digest = 0;
  uint64_t digest = 0;  ///< of the bytes before it
};

struct RecordStart {
  RecordKey key;
  uint64_t bytes = 0;
  uint64_t bytes_digest = 0;
  uint64_t digest = 0;  ///< of the bytes before it
};

template <class Start>
uint64_t digest_of_start(const Start& start) {
  return digest_of(std::as_bytes(std::span(&start, 1)).first(offsetof(Start, digest)));
}

template <class... Args>
Failure damaged(const std::filesystem::path& path, uint64_t at, fmt::format_string<Args...> text,
                Args&&... args) {
  return fail(ErrorCode::bad_input, "{} is damaged at byte {}: {}; remove it and start over",
              path.string(), at, fmt::format(text, std::forward<Args>(args)...));
}

Failure io_error(const char* verb, const std::filesystem::path& path, int error) {
  return fail(code_of_write(error), "cannot {} {}: {}", verb, path.string(), std::strerror(error));
}

template <class T>
int read_at(int file, uint64_t offset, std::span<T> out) {
  const std::span<std::byte> bytes = std::as_writable_bytes(out);
  return transfer_all(::pread, file, bytes.data(), bytes.size(), off_t(offset));
}

int write_at(int file, uint64_t offset, std::span<const std::byte> bytes) {
  return transfer_all(::pwrite, file, bytes.data(), bytes.size(), off_t(offset));
}

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

}  // namespace

RecordFile::RecordFile(std::filesystem::path path, int file)
    : path_(std::move(path)), file_(file) {}
RecordFile::RecordFile(RecordFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      header_(std::move(other.header_)),
      mutex_(std::move(other.mutex_)),
      end_(other.end_),
      positions_(std::move(other.positions_)) {}
RecordFile& RecordFile::operator=(RecordFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(file_, other.file_);
  std::swap(header_, other.header_);
  std::swap(mutex_, other.mutex_);
  std::swap(end_, other.end_);
  std::swap(positions_, other.positions_);
  return *this;
}
RecordFile::~RecordFile() {
  if (file_ >= 0) ::close(file_);
}

std::filesystem::path RecordFile::unfinished_name(const std::filesystem::path& path) {
  return path.string() + ".new";
}

Result<RecordFile> RecordFile::create(const std::filesystem::path& path, std::string_view header) {
  const std::string unfinished = unfinished_name(path).string();
  // A link of that name would lead elsewhere.
  const int file =
      ::open(unfinished.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file < 0) return io_error("write", path, errno);
  RecordFile out(path, file);
  FileStart start;
  start.header_bytes = header.size();
  start.header_digest = digest_of(std::as_bytes(std::span(header)));
  start.digest = digest_of_start(start);
  int error = write_at(file, 0, bytes_of(start));
  if (error == 0) error = write_at(file, sizeof(start), std::as_bytes(std::span(header)));
  if (error == 0 && ::fsync(file) != 0 && errno != EINVAL) error = errno;
  if (error == 0 && ::rename(unfinished.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(unfinished.c_str());
    return io_error("write", path, error);
  }
  out.header_ = header;
  out.end_ = sizeof(start) + header.size();
  return out;
}

Result<RecordFile> RecordFile::open(const std::filesystem::path& path, Check check) {
  return open(path, O_RDWR | O_NOFOLLOW, check);
}

Result<RecordFile> RecordFile::open_to_read(const std::filesystem::path& path, Check check) {
  // Without O_NONBLOCK a pipe would be waited for until somebody writes to it.
  return open(path, O_RDONLY | O_NONBLOCK, check);
}

Result<RecordFile> RecordFile::open(const std::filesystem::path& path, int flags, Check check) {
  const int file = ::open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0 && errno == ELOOP && (flags & O_NOFOLLOW) != 0)
    return fail(ErrorCode::io,
                "{} is a symbolic link, and the file that it names would grow; remove it",
                path.string());
  if (file < 0) return io_error("open", path, errno);
  RecordFile out(path, file);
  struct stat about {};
  if (::fstat(file, &about) != 0) return io_error("open", path, errno);
  if (!S_ISREG(about.st_mode))
    return fail(ErrorCode::io, "{} is not a file on a disk; only those can be read", path.string());
  LUXEL_TRY_STATUS(out.read_header(uint64_t(about.st_size)));
  const Status read = out.read_records(uint64_t(about.st_size), check);
  // A network file system may show how long a file is before it shows what is in it.
  if ((flags & O_ACCMODE) != O_RDWR) return out;
  LUXEL_TRY_STATUS(read);
  LUXEL_TRY_STATUS(out.cut_off(uint64_t(about.st_size)));
  return out;
}

Status RecordFile::read_header(uint64_t file_bytes) {
  FileStart start;
  if (file_bytes < sizeof(start))
    return damaged(path_, file_bytes, "it ends within its first {} bytes", sizeof(start));
  if (const int error = read_at(file_, 0, std::span(&start, 1)))
    return io_error("read", path_, error);
  if (start.magic != kMagic) return damaged(path_, 0, "it is not a file of records in format 2");
  if (start.digest != digest_of_start(start)) return damaged(path_, 0, "its start is corrupt");
  if (start.header_bytes > file_bytes - sizeof(start))
    return damaged(path_, file_bytes, "it ends within its header");
  header_.resize(start.header_bytes);
  if (const int error = read_at(file_, sizeof(start), std::span(header_)))
    return io_error("read", path_, error);
  if (digest_of(std::as_bytes(std::span(header_))) != start.header_digest)
    return damaged(path_, sizeof(start), "its header is corrupt");
  end_ = sizeof(start) + start.header_bytes;
  return {};
}

/// The record at end_. False: it is cut off by the end of the file.
Result<bool> RecordFile::read_record(uint64_t file_bytes, Check check,
                                     std::vector<std::byte>& bytes) {
  if (file_bytes - end_ < sizeof(RecordStart)) return false;
  RecordStart start;
  if (const int error = read_at(file_, end_, std::span(&start, 1)))
    return io_error("read", path_, error);
  if (start.digest != digest_of_start(start))
    return damaged(path_, end_, "the start of record {} is corrupt", positions_.size() + 1);
  const uint64_t data = end_ + sizeof(start);
  if (start.bytes > file_bytes - data) return false;
  if (check == Check::now) {
    bytes.resize(start.bytes);
    if (const int error = read_at(file_, data, std::span(bytes)))
      return io_error("read", path_, error);
    if (digest_of(bytes) != start.bytes_digest)
      return damaged(path_, data, "record {} is corrupt", positions_.size() + 1);
  }
  positions_[start.key] = {data, start.bytes, start.bytes_digest};
  end_ = data + start.bytes;
  return true;
}

Status RecordFile::read_records(uint64_t file_bytes, Check check) {
  std::vector<std::byte> bytes;
  for (bool more = true; more;) {
    LUXEL_TRY(more, read_record(file_bytes, check, bytes));
  }
  return {};
}

/// The rest of an unfinished record must not stand behind a shorter one.
Status RecordFile::cut_off(uint64_t file_bytes) {
  if (end_ < file_bytes && ::ftruncate(file_, off_t(end_)) != 0)
    return io_error("write", path_, errno);
  return {};
}

Status RecordFile::append(RecordKey key, std::span<const std::byte> bytes) {
  RecordStart start{key, bytes.size(), digest_of(bytes), 0};
  start.digest = digest_of_start(start);
  const std::lock_guard lock(*mutex_);
  int error = write_at(file_, end_, bytes_of(start));
  if (error == 0) error = write_at(file_, end_ + sizeof(start), bytes);
  if (error != 0) {
    // Bytes that cannot be cut off here are cut off when the file is opened.
    if (::ftruncate(file_, off_t(end_)) != 0) errno = 0;
    return io_error("write", path_, error);
  }
  positions_[key] = {end_ + sizeof(start), bytes.size(), start.bytes_digest};
  end_ += sizeof(start) + bytes.size();
  return {};
}

size_t RecordFile::record_count() const {
  const std::lock_guard lock(*mutex_);
  return positions_.size();
}

std::vector<RecordKey> RecordFile::keys() const {
  const std::lock_guard lock(*mutex_);
  std::vector<RecordKey> out;
  for (const auto& [key, place] : positions_) out.push_back(key);
  return out;
}

uint64_t RecordFile::bytes() const {
  const std::lock_guard lock(*mutex_);
  return end_;
}

std::optional<RecordFile::RecordPosition> RecordFile::position_of(RecordKey key) const {
  const std::lock_guard lock(*mutex_);
  const auto found = positions_.find(key);
  if (found == positions_.end()) return std::nullopt;
  return found->second;
}

std::optional<uint64_t> RecordFile::size_of(RecordKey key) const {
  const std::optional<RecordPosition> place = position_of(key);
  if (!place) return std::nullopt;
  return place->bytes;
}

bool RecordFile::read(RecordKey key, uint64_t offset, std::span<std::byte> out) const {
  const std::optional<RecordPosition> place = position_of(key);
  if (!place || offset > place->bytes || out.size() > place->bytes - offset) return false;
  return read_at(file_, place->offset + offset, out) == 0;
}

std::optional<std::vector<std::byte>> RecordFile::read_whole(RecordKey key) const {
  std::vector<std::byte> bytes;
  if (!read_whole(key, bytes)) return std::nullopt;
  return bytes;
}

bool RecordFile::read_whole(RecordKey key, std::vector<std::byte>& out) const {
  const std::optional<RecordPosition> place = position_of(key);
  if (!place) return false;
  out.resize(place->bytes);
  return read_at(file_, place->offset, std::span(out)) == 0 && digest_of(out) == place->digest;
}

void RecordFile::flush() const { ::fdatasync(file_); }

}  // namespace base
}  // namespace luxel
