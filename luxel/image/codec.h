// Images to and from bytes. Every decoder refuses broken input with a sentence; encoders never
// emit NaN or infinity (LUXEL_CHECK on the input).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/team.h"
#include "luxel/image/half.h"
#include "luxel/image/image.h"

namespace luxel::image {

/// 8-bit pixels as a file holds them: display values, not linear light.
struct Image8 {
  int width = 0, height = 0, channels = 0;  ///< channels 1..4
  std::vector<uint8_t> data;
};

/// Asked for a picture's width and height before memory for its pixels is taken. Its error is the
/// decoder's.
using AllowSize = std::function<Status(uint32_t width, uint32_t height)>;

/// PNG, JPEG (what glTF allows), WebP (its extension EXT_texture_webp), BMP or TGA (what older
/// files name) to RGBA. `name` is the file or texture named in errors. Errors: another format
/// (unsupported); damaged; too large; not allowed.
Result<Image8> decode_ldr(std::span<const std::byte> bytes, std::string_view name,
                          const AllowSize& allow = {});
/// Display values in [0, 1], four channels, of a file as for decode_ldr, with all 16 bits that a
/// PNG may have.
Result<Image> decode_display(std::span<const std::byte> bytes, std::string_view name);
/// Any number of channels from 1 to 4, without loss.
std::vector<std::byte> encode_png(const Image8& image);

/// OpenEXR scan lines, 32-bit float, ZIP; channels named R, G, B, A in this order (1 to 4).
Result<std::vector<std::byte>> encode_exr(const Image& image);
/// encode_exr() by the members of a team, which all have the picture, some rows each. All get the
/// file. Errors: those of encode_exr(); cancelled, another member gives up.
Result<std::vector<std::byte>> encode_exr_together(const Image& image, Team* team,
                                                   Progress& progress);
/// encode_exr() with 16-bit floats, as they are: values are divided by the image's scale.
Result<std::vector<std::byte>> encode_exr(const HalfImage& image);
/// Channels R, G, B and, when present, A; a file without R, G, B is an error.
Result<Image> decode_exr(std::span<const std::byte> bytes, std::string_view name);

/// Radiance .hdr (RGBE) to three channels of linear light, divided by the file's EXPOSURE and
/// COLORCORR; flat or with either run-length code, in any of the eight orientations. PRIMARIES and
/// other header lines are ignored, as everywhere; the XYZ variant is an error.
Result<Image> decode_hdr(std::span<const std::byte> bytes, std::string_view name);
/// The first three channels, rounded to the 8 bits that share an exponent; negative values become
/// 0.
std::vector<std::byte> encode_hdr(const Image& image);

/// Linear light to 8-bit sRGB, clamped to [0, 1]; channel 3, when present, stays linear.
Image8 to_srgb8(const Image& linear);

}  // namespace luxel::image
