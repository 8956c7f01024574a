// BMP and TGA through stb, for the old models that name them. This stb leaves the pixels of a file
// that ends early, and colours beyond the end of a palette, as it finds them in memory: both are
// looked for here.
#include <stb/stb_image.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "luxel/image/codec_ldr.h"

namespace luxel::image {
namespace {

using Bytes = std::span<const uint8_t>;

Bytes bytes_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()};
}

uint32_t u16(Bytes p, size_t at) { return uint32_t(p[at]) | uint32_t(p[at + 1]) << 8; }
uint32_t u32(Bytes p, size_t at) { return u16(p, at) | u16(p, at + 2) << 16; }

Failure ends_early(const char* kind, std::string_view name) {
  return fail(ErrorCode::bad_input, "{}: the {} picture ends early", name, kind);
}

Result<Image8> decode(Bytes bytes, const char* kind, std::string_view name) {
  std::optional<Image8> image = load_with_stb(bytes);
  if (!image)
    return fail(ErrorCode::unsupported, "{}: cannot decode the {} picture: {}; convert it to PNG",
                name, kind, stbi_failure_reason());
  return *std::move(image);
}

// BMP: 14 bytes with the place of the pixels, a header with its own size, a palette, pixels.

constexpr size_t kBmpStart = 14;

/// The file with 256 colours where it has a palette, black beyond its own, and with the pixels
/// right behind, where stb wants them.
std::vector<uint8_t> packed(Bytes file, size_t header_end, bool has_palette, size_t pixels) {
  const size_t colors = has_palette ? std::min<size_t>(256, (pixels - header_end) / 4) : 0;
  std::vector<uint8_t> out(header_end + (has_palette ? 4 * 256 : 0));
  std::memcpy(out.data(), file.data(), header_end + 4 * colors);
  for (size_t k = 0; k < 4; ++k) out[10 + k] = uint8_t(out.size() >> 8 * k);
  out.insert(out.end(), file.begin() + ptrdiff_t(pixels), file.end());
  return out;
}

// TGA: 18 bytes, a text, a palette, pixels.

constexpr size_t kTgaStart = 18;

struct Tga {
  size_t text_bytes, palette_type, kind, palette_first, palette_count, palette_bits;
  uint32_t width, height;
  size_t bits, flags;
};

std::optional<Tga> tga_of(Bytes p) {
  if (p.size() < kTgaStart) return std::nullopt;
  return Tga{p[0], p[1], p[2], u16(p, 3), u16(p, 5), p[7], u16(p, 12), u16(p, 14), p[16], p[17]};
}

bool is_depth(size_t bits) {
  return bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

/// True where `count` pixels are there, packed by runs: a byte with how many less 1, its highest
/// bit set where one pixel stands for all of them.
bool holds_runs(Bytes in, size_t count, size_t pixel_bytes) {
  size_t at = 0;
  for (size_t done = 0; done < count;) {
    if (at >= in.size()) return false;
    const size_t length = size_t(in[at] & 127) + 1;
    at += 1 + ((in[at] & 128) != 0 ? 1 : length) * pixel_bytes;
    done += length;
  }
  return at <= in.size();
}

}  // namespace

bool is_bmp(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{'B'} && bytes[1] == std::byte{'M'};
}

Result<Image8> decode_bmp(std::span<const std::byte> encoded, std::string_view name,
                          const AllowSize& allow) {
  const Bytes file = bytes_of(encoded);
  if (file.size() < kBmpStart + 40 || file.size() > size_t(INT32_MAX) / 2)
    return ends_early("BMP", name);
  const size_t pixels = u32(file, 10), header = u32(file, 14), bits = u16(file, 28);
  if (header < 40 || header > 124)
    return fail(ErrorCode::unsupported, "{}: its BMP header has {} bytes; convert it to PNG", name,
                header);
  constexpr uint32_t kMasks = 3;  // bits of red, green and blue follow the oldest header
  const size_t end = kBmpStart + header + (header == 40 && u32(file, 30) == kMasks ? 12 : 0);
  const uint32_t width = u32(file, 18), stated = u32(file, 22);
  const uint32_t height = stated >> 31 != 0 ? 0 - stated : stated;  // negative: from top to bottom
  LUXEL_TRY_STATUS(check_picture_size(width, height, name));
  const uint64_t row = (uint64_t(width) * bits + 31) / 32 * 4;
  if (bits > 32 || pixels < end || pixels > file.size() || row * height > file.size() - pixels)
    return ends_early("BMP", name);
  if (allow) LUXEL_TRY_STATUS(allow(width, height));
  if (bits > 8 && pixels == end) return decode(file, "BMP", name);
  return decode(packed(file, end, bits <= 8, pixels), "BMP", name);
}

bool is_tga(std::span<const std::byte> bytes) {
  const auto tga = tga_of(bytes_of(bytes));
  if (!tga || tga->width == 0 || tga->height == 0) return false;
  const size_t kind = tga->kind & ~size_t(8);  // 8: packed by runs
  if (tga->palette_type == 1)
    return kind == 1 && is_depth(tga->palette_bits) && (tga->bits == 8 || tga->bits == 16);
  return tga->palette_type == 0 && (kind == 2 || kind == 3) && is_depth(tga->bits);
}

Result<Image8> decode_tga(std::span<const std::byte> encoded, std::string_view name,
                          const AllowSize& allow) {
  const Bytes file = bytes_of(encoded);
  const Tga tga = *tga_of(file);
  LUXEL_TRY_STATUS(check_picture_size(tga.width, tga.height, name));
  constexpr size_t kRightToLeft = 0x10, kAlphaBits = 0x0f;
  if (tga.palette_first != 0 || (tga.flags & kRightToLeft) != 0)
    return fail(ErrorCode::unsupported,
                "{}: its TGA picture runs from right to left or has a part of a palette; convert "
                "it to PNG",
                name);
  const size_t pixel_bytes = (tga.bits + 7) / 8, count = size_t(tga.width) * tga.height;
  const size_t palette = tga.palette_type * tga.palette_count * ((tga.palette_bits + 7) / 8);
  const size_t start = kTgaStart + tga.text_bytes + palette;
  if (start > file.size() || file.size() > size_t(INT32_MAX)) return ends_early("TGA", name);
  const Bytes pixels = file.subspan(start);
  const bool is_whole = (tga.kind & 8) != 0 ? holds_runs(pixels, count, pixel_bytes)
                                            : pixels.size() / pixel_bytes >= count;
  if (!is_whole) return ends_early("TGA", name);
  if (allow) LUXEL_TRY_STATUS(allow(tga.width, tga.height));
  LUXEL_TRY(Image8 image, decode(file, "TGA", name));
  if ((tga.flags & kAlphaBits) == 0)  // then the fourth byte of a pixel means nothing
    for (size_t i = 3; i < image.data.size(); i += 4) image.data[i] = 255;
  return image;
}

}  // namespace luxel::image
