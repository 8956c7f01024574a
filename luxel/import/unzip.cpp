#include "luxel/import/unzip.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace luxel::import {
namespace {

/// Deflate makes at most so many bytes of one.
constexpr uint64_t kMostOfOne = 1032;

using Bytes = std::span<const std::byte>;

/// A little-endian number of `size` bytes; 0 past the end.
uint32_t number_at(Bytes file, size_t at, size_t size) {
  uint32_t value = 0;
  if (at <= file.size() && file.size() - at >= size) std::memcpy(&value, file.data() + at, size);
  return value;
}

/// The record that ends an archive, behind which a comment may stand.
std::optional<size_t> find_end_record(Bytes file) {
  constexpr size_t kSize = 22, kLongestComment = 65535;
  if (file.size() < kSize) return std::nullopt;
  const size_t first = file.size() - std::min(file.size(), kSize + kLongestComment);
  for (size_t at = file.size() - kSize + 1; at-- > first;)
    if (number_at(file, at, 4) == 0x06054b50) return at;
  return std::nullopt;
}

struct ZipEntry {
  std::string name;
  uint32_t method = 0, packed = 0, size = 0, at = 0;  ///< `at`: of its own header
};

/// None when there is none at `at`; moves it behind the entry.
std::optional<ZipEntry> next_entry(Bytes file, size_t& at) {
  constexpr size_t kSize = 46;
  if (number_at(file, at, 4) != 0x02014b50) return std::nullopt;
  const size_t name = number_at(file, at + 28, 2), extra = number_at(file, at + 30, 2),
               comment = number_at(file, at + 32, 2);
  if (file.size() - at < kSize + name) return std::nullopt;
  ZipEntry entry{std::string(reinterpret_cast<const char*>(file.data()) + at + kSize, name),
                 number_at(file, at + 10, 2), number_at(file, at + 20, 4),
                 number_at(file, at + 24, 4), number_at(file, at + 42, 4)};
  at += kSize + name + extra + comment;
  return entry;
}

/// The packed bytes of an entry; none when they would lie outside of the file.
std::optional<Bytes> bytes_of_entry(Bytes file, const ZipEntry& entry) {
  constexpr size_t kSize = 30;
  if (number_at(file, entry.at, 4) != 0x04034b50) return std::nullopt;
  const size_t start = size_t(entry.at) + kSize + number_at(file, entry.at + 26, 2) +
                       number_at(file, entry.at + 28, 2);
  if (start > file.size() || file.size() - start < entry.packed) return std::nullopt;
  return file.subspan(start, entry.packed);
}

}  // namespace

std::vector<std::byte> inflate_all(std::span<const std::byte> packed) {
  std::vector<std::byte> out;
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) return out;
  std::array<std::byte, 1 << 16> part;
  int state = Z_OK;
  while (state == Z_OK) {
    if (stream.avail_in == 0) {
      const size_t given = std::min<size_t>(packed.size(), 1 << 30);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
      stream.avail_in = uInt(given);
      packed = packed.subspan(given);
    }
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = uInt(part.size());
    state = ::inflate(&stream, Z_NO_FLUSH);
    out.insert(out.end(), part.begin(), part.end() - stream.avail_out);
  }
  ::inflateEnd(&stream);
  return out;
}

Result<std::vector<PackedFile>> unzip(const SourceFile& source) {
  const Bytes file(source.bytes);
  const auto end = find_end_record(file);
  if (!end) return fail(ErrorCode::bad_input, "{}: it is not a zip archive", source.name);
  size_t at = number_at(file, *end + 16, 4);
  std::vector<PackedFile> files;
  for (uint32_t count = number_at(file, *end + 10, 2); count > 0; --count) {
    const auto entry = next_entry(file, at);
    if (!entry) return fail(ErrorCode::bad_input, "{}: its list of files is damaged", source.name);
    const auto packed = bytes_of_entry(file, *entry);
    const bool stored = entry->method == 0;
    if (!packed || (!stored && entry->method != 8) ||
        entry->size > (stored ? entry->packed : kMostOfOne * entry->packed))
      return fail(ErrorCode::bad_input, "{}: the file '{}' in it is damaged", source.name,
                  entry->name);
    files.push_back({entry->name, stored ? std::vector<std::byte>(packed->begin(), packed->end())
                                         : inflate_all(*packed)});
  }
  return files;
}

}  // namespace luxel::import
