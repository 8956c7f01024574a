// 8-bit pictures in: PNG and JPEG through stb, WebP through libwebp. stb checks neither PNG's CRCs
// nor whether a JPEG is complete, and would hand out garbage pixels for a damaged file: both are
// checked here first.
#include <fmt/format.h>
#include <stb/stb_image.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>

#include "luxel/image/codec.h"
#include "luxel/image/codec_webp.h"

namespace luxel::image {
namespace {

constexpr std::array<uint8_t, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

using Bytes = std::span<const uint8_t>;

bool starts_with(Bytes bytes, Bytes magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

uint32_t big_endian32(Bytes p) {
  return uint32_t(p[0]) << 24 | uint32_t(p[1]) << 16 | uint32_t(p[2]) << 8 | uint32_t(p[3]);
}

constexpr std::array<uint32_t, 256> make_crc_table() {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}

/// The CRC of PNG chunks. [ISO 15948, annex D]
uint32_t crc32(Bytes bytes) {
  static constexpr std::array<uint32_t, 256> kTable = make_crc_table();
  uint32_t c = 0xffffffffu;
  for (const uint8_t b : bytes) c = kTable[(c ^ b) & 0xff] ^ (c >> 8);
  return ~c;
}

/// What is wrong with the chunks of a PNG file; empty when they are whole up to IEND.
/// A chunk: length of its data, type (4 letters), data, CRC over type and data.
std::string damage_of_png(Bytes bytes) {
  size_t at = kPngMagic.size();
  for (;;) {
    if (bytes.size() - at < 12) return "it ends early";
    const size_t length = big_endian32(bytes.subspan(at));
    if (length > bytes.size() - at - 12) return "it ends early";
    const Bytes type_and_data = bytes.subspan(at + 4, 4 + length);
    if (crc32(type_and_data) != big_endian32(bytes.subspan(at + 8 + length)))
      return fmt::format("the checksum at byte {} does not match", at);
    if (std::memcmp(type_and_data.data(), "IEND", 4) == 0) return {};
    at += 12 + length;
  }
}

/// What is wrong with a segment of Huffman tables, behind its two bytes of length. A table says how
/// many codes there are of 1 to 16 bits, then their values. stb takes more codes of a length than
/// there can be, and ends the process or looks beyond its tables. [JPEG, B.2.4.2 and C.2]
std::string damage_of_tables(Bytes segment) {
  constexpr std::string_view kDamage = "a table of codes is not one";
  constexpr size_t kLengths = 16, kMostCodes = 256;
  while (!segment.empty()) {
    if (segment.size() < 1 + kLengths) return std::string(kDamage);
    size_t codes = 0, free = 1;  // `free`: codes of this length that begin like none so far
    for (size_t k = 1; k <= kLengths; ++k) {
      free *= 2;
      if (segment[k] > free) return std::string(kDamage);
      free -= segment[k], codes += segment[k];
    }
    if (codes > kMostCodes || segment.size() < 1 + kLengths + codes) return std::string(kDamage);
    segment = segment.subspan(1 + kLengths + codes);
  }
  return {};
}

/// What is wrong with the segments of a JPEG file. The end marker may also stand in the thumbnail
/// of an APP segment, so these are stepped over before it is looked for.
std::string damage_of_jpeg(Bytes bytes) {
  constexpr uint8_t kTables = 0xc4, kStartOfScan = 0xda, kEndOfImage = 0xd9;
  const auto tables_at = [&](size_t marker) -> std::string {
    const size_t length = size_t(bytes[marker + 2]) << 8 | bytes[marker + 3];
    if (length < 2 || length > bytes.size() - marker - 2) return "it ends early";
    return damage_of_tables(bytes.subspan(marker + 4, length - 2));
  };
  size_t at = 2;
  while (bytes.size() - at >= 4) {
    if (bytes[at] != 0xff) return fmt::format("there is no marker at byte {}", at);
    const uint8_t marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const size_t length = size_t(bytes[at + 2]) << 8 | bytes[at + 3];
    if (length < 2 || length > bytes.size() - at - 2) return "it ends early";
    if (marker == kTables)
      if (const std::string damage = tables_at(at); !damage.empty()) return damage;
    at += 2 + length;
    if (marker != kStartOfScan) continue;
    // In the pixels' codes no marker stands by chance. Scans may bring tables of their own.
    for (size_t i = at; i + 1 < bytes.size(); ++i) {
      if (bytes[i] != 0xff) continue;
      if (bytes[i + 1] == kEndOfImage) return {};
      if (bytes[i + 1] != kTables || i + 4 > bytes.size()) continue;
      if (const std::string damage = tables_at(i); !damage.empty()) return damage;
    }
    return "it ends early";
  }
  return "it ends early";
}

uint32_t big_endian16(Bytes p) { return uint32_t(p[0]) << 8 | uint32_t(p[1]); }

/// Width and height by the first header that states them; only for what damage_of_...() found
/// whole. A PNG begins with it; of a JPEG it is the first frame (SOF0 to SOF15).
std::array<uint32_t, 2> stated_size(Bytes bytes, bool is_png) {
  if (is_png) {
    if (bytes.size() < 24) return {};
    return {big_endian32(bytes.subspan(16)), big_endian32(bytes.subspan(20))};
  }
  for (size_t at = 2; bytes.size() - at >= 9;) {
    const uint8_t marker = bytes[at + 1];
    const bool is_frame = (marker & 0xf0) == 0xc0 && marker != 0xc4 && marker != 0xc8 &&
                          marker != 0xcc;  // tables and an extension stand among the frames
    if (is_frame) return {big_endian16(bytes.subspan(at + 7)), big_endian16(bytes.subspan(at + 5))};
    at += marker == 0xff ? 1 : 2 + big_endian16(bytes.subspan(at + 2));
    if (at > bytes.size()) break;
  }
  return {};
}

/// The bytes as stb takes them, after all checks that it does not make itself.
Result<Bytes> checked(std::span<const std::byte> bytes, std::string_view name) {
  const Bytes data(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  if (data.empty()) return fail(ErrorCode::bad_input, "{}: the picture is empty", name);
  const bool is_png = starts_with(data, kPngMagic);
  const bool is_jpeg = starts_with(data, std::array<uint8_t, 3>{0xff, 0xd8, 0xff});
  if (!is_png && !is_jpeg)
    return fail(ErrorCode::bad_input,
                "{}: the picture is neither PNG, JPEG nor WebP; convert it to one of them", name);
  const std::string damage = is_png ? damage_of_png(data) : damage_of_jpeg(data);
  if (!damage.empty() || data.size() > size_t(INT32_MAX))
    return fail(ErrorCode::bad_input, "{}: the {} picture is damaged: {}", name,
                is_png ? "PNG" : "JPEG", damage.empty() ? "it is over 2 GB" : damage);
  // Before anything else: a short file may state a size that no memory holds.
  const auto [stated_width, stated_height] = stated_size(data, is_png);
  LUXEL_TRY_STATUS(check_picture_size(stated_width, stated_height, name));
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data.data(), int(data.size()), &width, &height, &channels))
    return fail(ErrorCode::bad_input, "{}: cannot decode the picture: {}", name,
                stbi_failure_reason());
  LUXEL_TRY_STATUS(check_picture_size(uint32_t(width), uint32_t(height), name));
  return data;
}

/// `load` is stb's reader for one depth: width, height and channels come back through it.
template <class Load>
auto load_rgba(const Load& load, Bytes data, int& width, int& height) {
  int channels = 0;
  auto* pixels = load(data.data(), int(data.size()), &width, &height, &channels, 4);
  return std::unique_ptr<std::remove_pointer_t<decltype(pixels)>, void (*)(void*)>(pixels,
                                                                                   stbi_image_free);
}

}  // namespace

Status check_picture_size(uint32_t width, uint32_t height, std::string_view name) {
  constexpr uint32_t kMaxSide = 16384;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    return fail(ErrorCode::bad_input, "{}: the picture has {} x {} pixels, must be 1 to {} a side",
                name, width, height, kMaxSide);
  return {};
}

Result<Image8> decode_ldr(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow) {
  if (is_webp(bytes)) return decode_webp(bytes, name, allow);
  LUXEL_TRY(const Bytes data, checked(bytes, name));
  if (allow) {
    const auto [width, height] = stated_size(data, starts_with(data, kPngMagic));
    LUXEL_TRY_STATUS(allow(width, height));
  }
  Image8 image{0, 0, 4, {}};
  const auto pixels = load_rgba(stbi_load_from_memory, data, image.width, image.height);
  if (pixels == nullptr)
    return fail(ErrorCode::bad_input, "{}: cannot decode the picture: {}", name,
                stbi_failure_reason());
  image.data.assign(pixels.get(),
                    pixels.get() + size_t(4) * size_t(image.width) * size_t(image.height));
  return image;
}

Result<Image> decode_display(std::span<const std::byte> bytes, std::string_view name) {
  if (is_webp(bytes)) {
    LUXEL_TRY(const Image8 webp, decode_webp(bytes, name, {}));
    Image image(webp.width, webp.height, 4);
    for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = float(webp.data[i]) / 255.0f;
    return image;
  }
  LUXEL_TRY(const Bytes data, checked(bytes, name));
  int width = 0, height = 0;
  const auto pixels = load_rgba(stbi_load_16_from_memory, data, width, height);
  if (pixels == nullptr)
    return fail(ErrorCode::bad_input, "{}: cannot decode the picture: {}", name,
                stbi_failure_reason());
  Image image(width, height, 4);
  // stb gives 257 v for a byte v: v / 255 after the division.
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = float(pixels.get()[i]) / 65535.0f;
  return image;
}

}  // namespace luxel::image
