// PNG through stb, which checks no CRCs and would hand out garbage pixels for a damaged file: they
// are checked here first. stb's global knobs are left at their defaults on purpose: they belong to
// the process, and other threads may be at work.
#include <fmt/format.h>
#include <stb/stb_image.h>
#include <zlib.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>

#include "luxel/image/codec_ldr.h"

namespace luxel::image {
namespace {

constexpr std::array<uint8_t, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

using Bytes = std::span<const uint8_t>;

uint32_t big_endian32(Bytes p) {
  return uint32_t(p[0]) << 24 | uint32_t(p[1]) << 16 | uint32_t(p[2]) << 8 | uint32_t(p[3]);
}

/// Damage in the chunks of a PNG file; empty when they are whole up to IEND. A chunk: length of its
/// data, type (4 letters), data, CRC over type and data.
std::string damage_of_png(Bytes bytes) {
  size_t at = kPngMagic.size();
  for (;;) {
    if (bytes.size() - at < 12) return "it ends early";
    const size_t length = big_endian32(bytes.subspan(at));
    if (length > bytes.size() - at - 12) return "it ends early";
    const Bytes type_and_data = bytes.subspan(at + 4, 4 + length);
    if (crc32_z(0, type_and_data.data(), type_and_data.size()) !=
        big_endian32(bytes.subspan(at + 8 + length)))
      return fmt::format("the checksum at byte {} does not match", at);
    if (std::memcmp(type_and_data.data(), "IEND", 4) == 0) return {};
    at += 12 + length;
  }
}

Error undecodable(std::string_view name) {
  return {ErrorCode::bad_input,
          fmt::format("{}: cannot decode the picture: {}", name, stbi_failure_reason())};
}

/// The bytes as stb takes them, after all checks that it does not make itself.
Result<Bytes> checked(std::span<const std::byte> bytes, std::string_view name,
                      const AllowSize& allow) {
  const Bytes data(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  const std::string damage =
      data.size() > size_t(INT32_MAX) ? "it is over 2 GB" : damage_of_png(data);
  if (!damage.empty())
    return fail(ErrorCode::bad_input, "{}: the PNG picture is damaged: {}", name, damage);
  int width = 0, height = 0, channels = 0;
  // Before anything else: a short file may state a size that no memory holds.
  if (data.size() >= 24)
    LUXEL_TRY_STATUS(
        check_picture_size(big_endian32(data.subspan(16)), big_endian32(data.subspan(20)), name));
  if (!stbi_info_from_memory(data.data(), int(data.size()), &width, &height, &channels))
    return Failure{undecodable(name)};
  LUXEL_TRY_STATUS(check_picture_size(uint32_t(width), uint32_t(height), name));
  if (allow) LUXEL_TRY_STATUS(allow(uint32_t(width), uint32_t(height)));
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

std::optional<Image8> load_with_stb(std::span<const uint8_t> bytes) {
  Image8 image{0, 0, 4, {}};
  const auto pixels = load_rgba(stbi_load_from_memory, bytes, image.width, image.height);
  if (pixels == nullptr) return std::nullopt;
  image.data.assign(pixels.get(),
                    pixels.get() + size_t(4) * size_t(image.width) * size_t(image.height));
  return image;
}

bool is_png(std::span<const std::byte> bytes) {
  return bytes.size() >= kPngMagic.size() &&
         std::memcmp(bytes.data(), kPngMagic.data(), kPngMagic.size()) == 0;
}

Result<Image8> decode_png(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow) {
  LUXEL_TRY(const Bytes data, checked(bytes, name, allow));
  std::optional<Image8> image = load_with_stb(data);
  if (!image) return Failure{undecodable(name)};
  return *std::move(image);
}

Result<Image> decode_png_values(std::span<const std::byte> bytes, std::string_view name) {
  LUXEL_TRY(const Bytes data, checked(bytes, name, {}));
  int width = 0, height = 0;
  const auto pixels = load_rgba(stbi_load_16_from_memory, data, width, height);
  if (pixels == nullptr) return Failure{undecodable(name)};
  Image image(width, height, 4);
  // stb gives 257 v for a byte v: v / 255 after the division.
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = float(pixels.get()[i]) / 65535.0f;
  return image;
}

}  // namespace luxel::image
