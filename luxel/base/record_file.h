// A file of records that only grows, and survives the end of its writer at any moment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"

namespace luxel {
inline namespace base {

/// Key of a record, which is a part of some stage of the work.
struct RecordKey {
  uint64_t stage = 0, part = 0;
  friend auto operator<=>(const RecordKey&, const RecordKey&) = default;
};

/// The file's bytes are those of docs/method/checkpoints.md, numbers in the machine's byte order: a
/// header (a text of the owner's) and then records, each with a digest of its own. A record that is
/// cut off by the end of the file was being written when the writer died: it is as if it had never
/// been.
class RecordFile {
 public:
  /// The name under which a new file is written before it gets its own.
  static std::filesystem::path unfinished_name(const std::filesystem::path& path);

  /// A file with a header and no records, in place of what has that name. Only one process may do
  /// so at a time. Errors: the folder cannot be written to, the disk is full.
  static Result<RecordFile> create(const std::filesystem::path& path, std::string_view header);
  /// When the bytes of records are checked, whose starts are in any case.
  enum class Check : uint8_t {
    now,       ///< reads the file through
    when_read  ///< by read_whole()
  };
  /// A cut-off record at the file's end is taken away. Errors: no such file, a symbolic link, none
  /// of this kind, damaged: the sentence names the byte.
  static Result<RecordFile> open(const std::filesystem::path& path, Check check = Check::now);
  /// One that others may be writing: as far as it is sound now, and left as it is. Nothing is
  /// appended to it. Errors: no such file, none of this kind, a damaged header.
  static Result<RecordFile> open_to_read(const std::filesystem::path& path,
                                         Check check = Check::now);
  RecordFile(RecordFile&& other) noexcept;
  RecordFile& operator=(RecordFile&& other) noexcept;
  ~RecordFile();

  const std::string& header() const { return header_; }
  size_t record_count() const;
  std::vector<RecordKey> keys() const;  ///< of all records
  uint64_t bytes() const;

  /// Adds a record; of two with the same key the later one counts. Thread-safe. Errors: the disk is
  /// full; what was there before stays readable.
  Status append(RecordKey key, std::span<const std::byte> bytes);
  /// Bytes of a record; nothing where there is none. Thread-safe.
  std::optional<uint64_t> size_of(RecordKey key) const;
  /// A record's bytes from `offset` on into `out`. False where there is no such record, it is
  /// shorter, or the disk fails. Thread-safe.
  bool read(RecordKey key, uint64_t offset, std::span<std::byte> out) const;
  /// A record's bytes, checked. Nothing where there is no such record, it is damaged, or the disk
  /// fails. Thread-safe.
  std::optional<std::vector<std::byte>> read_whole(RecordKey key) const;
  /// Replaces what `out` holds by a record's bytes; false where there is nothing.
  bool read_whole(RecordKey key, std::vector<std::byte>& out) const;
  /// Waits until everything is on the disk, for the end of the machine rather than that of the
  /// process. Thread-safe, and others may append meanwhile.
  void flush() const;

 private:
  struct RecordPosition {
    uint64_t offset = 0, bytes = 0, digest = 0;
  };
  RecordFile(std::filesystem::path path, int file);
  static Result<RecordFile> open(const std::filesystem::path& path, int flags, Check check);
  Status read_header(uint64_t file_bytes);
  Status read_records(uint64_t file_bytes, Check check);
  Result<bool> read_record(uint64_t file_bytes, Check check, std::vector<std::byte>& bytes);
  Status cut_off(uint64_t file_bytes);
  std::optional<RecordPosition> position_of(RecordKey key) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::string header_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();  ///< of what follows
  uint64_t end_ = 0;
  std::map<RecordKey, RecordPosition> positions_;
};

}  // namespace base
}  // namespace luxel
