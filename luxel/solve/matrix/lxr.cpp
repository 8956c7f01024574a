#include "luxel/solve/matrix/lxr.h"

#include <zlib.h>

#include <algorithm>
#include <string_view>

#include "luxel/base/check.h"
#include "luxel/base/file.h"
#include "luxel/solve/matrix/lxr_fields.h"
#include "luxel/solve/matrix/relight_check.h"

namespace luxel::matrix {
namespace {

/// As PNG's: a byte that no text has, both kinds of line ends, and the end of a DOS text.
constexpr std::array<uint8_t, 8> kMagic{0x89, 'L', 'X', 'R', '\r', '\n', 0x1a, '\n'};

struct Header {
  std::array<uint8_t, 8> magic = kMagic;
  uint16_t major = kLxrMajor, minor = kLxrMinor;
  uint32_t chunks = 0;
  uint64_t file_bytes = 0;
  uint32_t reserved = 0;
  uint32_t crc = 0;  ///< of all bytes before it
};
template <class Archive>
void fields(Archive& a, Is<Header> auto& x) {
  a(x.magic, x.major, x.minor, x.chunks, x.file_bytes, x.reserved, x.crc);
}
constexpr size_t kHeaderBytes = 32;

using Tag = std::array<char, 4>;

struct ChunkHeader {
  uint32_t crc = 0;  ///< of all bytes of the chunk after it
  Tag tag{};
  uint64_t bytes = 0;  ///< after this header; a multiple of 8
};
template <class Archive>
void fields(Archive& a, Is<ChunkHeader> auto& x) {
  a(x.crc, x.tag, x.bytes);
}
constexpr size_t kChunkHeaderBytes = 16;

uint32_t crc_of(std::span<const std::byte> bytes) {
  return uint32_t(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void overwrite(std::vector<std::byte>& bytes, size_t at, const auto& x) {
  Writer writer;
  writer(x);
  std::copy(writer.bytes.begin(), writer.bytes.end(), bytes.begin() + std::ptrdiff_t(at));
}

Tag tag_of(std::string_view name) {
  Tag tag;
  LUXEL_CHECK(name.size() == tag.size());
  std::copy(name.begin(), name.end(), tag.begin());
  return tag;
}

/// For sentences: a damaged one may hold anything.
std::string readable(const Tag& tag) {
  std::string out(tag.begin(), tag.end());
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return out;
}

template <class... Args>
Failure fault(const std::string& where, fmt::format_string<Args...> text, Args&&... args) {
  return fail(ErrorCode::bad_input, "{}: {}; the file is damaged: copy or make it again", where,
              fmt::format(text, std::forward<Args>(args)...));
}

Result<Header> read_header(std::span<const std::byte> bytes, const std::string& name) {
  Header header;
  Reader reader(bytes.first(std::min(bytes.size(), kHeaderBytes)), name + ": header", 0);
  reader(header);
  const auto magic = std::as_bytes(std::span(kMagic)).first(std::min(bytes.size(), kMagic.size()));
  if (bytes.empty() || !std::equal(magic.begin(), magic.end(), bytes.begin()))
    return fail(ErrorCode::bad_input,
                "{}: is not an .lxr file: its first bytes are not those of one; "
                "`luxel relight` makes one from a scene",
                name);
  if (reader.error()) return Failure{*reader.error()};
  if (header.crc != crc_of(bytes.first(kHeaderBytes - sizeof header.crc)))
    return fault(name, "header, byte 0: the checksum is wrong");
  if (header.major != kLxrMajor)
    return fail(ErrorCode::unsupported,
                "{}: has version {}.{} of the format, this luxel reads {}.x; {}", name,
                header.major, header.minor, kLxrMajor,
                header.major > kLxrMajor ? "use a newer luxel" : "make the file again");
  if (header.file_bytes != bytes.size())
    return fault(name, "header, byte 16: {} bytes are promised, the file has {}", header.file_bytes,
                 bytes.size());
  if (header.reserved != 0) return fault(name, "header, byte 24: is not 0");
  return header;
}

struct Chunk {
  Tag tag{};
  size_t offset = 0, bytes = 0;  ///< of what it holds
  bool read = false;
};

/// Where chunks lie, their checksums being right.
Result<std::vector<Chunk>> find_chunks(std::span<const std::byte> bytes, const Header& header,
                                       const std::string& name) {
  std::vector<Chunk> chunks;
  size_t at = kHeaderBytes;
  while (at < bytes.size()) {
    const std::string where = fmt::format("{}: chunk {}, byte {}", name, chunks.size(), at);
    if (bytes.size() - at < kChunkHeaderBytes) return fault(where, "its header is cut off");
    ChunkHeader chunk;
    Reader reader(bytes.subspan(at, kChunkHeaderBytes), where, at);
    reader(chunk);
    if (chunk.bytes > bytes.size() - at - kChunkHeaderBytes || chunk.bytes % kAlignment != 0)
      return fault(where, "'{}' of {} bytes, {} are left", readable(chunk.tag), chunk.bytes,
                   bytes.size() - at - kChunkHeaderBytes);
    if (chunk.crc != crc_of(bytes.subspan(at + sizeof chunk.crc,
                                          kChunkHeaderBytes - sizeof chunk.crc + chunk.bytes)))
      return fault(where, "the checksum of '{}' is wrong", readable(chunk.tag));
    chunks.push_back({chunk.tag, at + kChunkHeaderBytes, chunk.bytes});
    at += kChunkHeaderBytes + chunk.bytes;
  }
  if (chunks.size() != header.chunks)
    return fault(name, "header, byte 12: {} chunks are promised, there are {}", header.chunks,
                 chunks.size());
  return chunks;
}

Status read_chunk(std::span<const std::byte> bytes, std::span<Chunk> chunks, Tag tag,
                  const std::string& name, const auto& read_fields) {
  const auto is_it = [&](const Chunk& c) { return c.tag == tag; };
  const auto chunk = std::find_if(chunks.begin(), chunks.end(), is_it);
  if (chunk == chunks.end()) return fault(name, "there is no chunk '{}'", readable(tag));
  if (std::find_if(chunk + 1, chunks.end(), is_it) != chunks.end())
    return fault(name, "there are two chunks '{}'", readable(tag));
  Reader reader(bytes.subspan(chunk->offset, chunk->bytes),
                fmt::format("{}: chunk '{}'", name, readable(tag)), chunk->offset);
  read_fields(reader);
  reader.end();
  if (reader.error()) return Failure{*reader.error()};
  chunk->read = true;
  return {};
}

}  // namespace

std::vector<std::byte> encode_lxr(const RelightData& data) {
  LUXEL_CHECK(check(data).has_value());
  Header header;
  Writer writer;
  writer(header);
  for_each_chunk(data, [&](std::string_view name, int, const auto& write_fields) {
    const size_t start = writer.bytes.size();
    writer(ChunkHeader{});
    write_fields(writer);
    writer.align();
    ChunkHeader chunk{0, tag_of(name), writer.bytes.size() - start - kChunkHeaderBytes};
    overwrite(writer.bytes, start, chunk);
    chunk.crc = crc_of(std::span(writer.bytes).subspan(start + sizeof chunk.crc));
    overwrite(writer.bytes, start, chunk);
    ++header.chunks;
  });
  header.file_bytes = writer.bytes.size();
  overwrite(writer.bytes, 0, header);
  header.crc = crc_of(std::span(writer.bytes).first(kHeaderBytes - sizeof header.crc));
  overwrite(writer.bytes, 0, header);
  return std::move(writer.bytes);
}

namespace {

/// Moves the places of files before 1.2, which lie on the surface, to where rays start: as far off
/// as the programs that wrote them did.
void lift_places(RelightData& data) {
  Box3 bounds;
  for (const Vec3& p : data.occluders.position) bounds.extend(p);
  const float diagonal_m = bounds.diagonal();
  const auto lift = [&](Vec3& p, Vec3 normal) {
    p += normal * (0x1p-18f * std::max(max_component(max(p, -p)), diagonal_m));
  };
  for (PatchPoint& p : data.probe) lift(p.position, p.normal);
  for (size_t i = 0; i < data.position.size(); ++i) lift(data.position[i], data.normal[i]);
  Target& to = data.target;
  for (size_t i = 0; i < to.position.size(); ++i) lift(to.position[i], to.geometric_normal[i]);
}

}  // namespace

Result<RelightData> decode_lxr(std::span<const std::byte> bytes, const std::string& name) {
  LUXEL_TRY(const Header header, read_header(bytes, name));
  LUXEL_TRY(std::vector<Chunk> chunks, find_chunks(bytes, header, name));
  RelightData data;
  Status status;
  for_each_chunk(data, [&](std::string_view tag, int minor, const auto& read_fields) {
    if (status && minor <= header.minor)
      status = read_chunk(bytes, chunks, tag_of(tag), name, read_fields);
  });
  LUXEL_TRY_STATUS(status);
  for (const Chunk& chunk : chunks)
    if (!chunk.read && header.minor <= kLxrMinor)
      return fault(name, "chunk '{}', byte {}: no such chunk is known in version {}.{}",
                   readable(chunk.tag), chunk.offset, header.major, header.minor);
  if (const Status right = check(data); !right) return fault(name, "{}", right.error().message);
  if (header.minor < 2) lift_places(data);
  return data;
}

Result<RelightData> read_lxr(const std::filesystem::path& path) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(path));
  return decode_lxr(bytes, path.string());
}

}  // namespace luxel::matrix
