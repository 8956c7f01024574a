// KHR_meshopt_compression beyond EXT_meshopt_compression: attributes of format 1 and the
// filter COLOR. Debian's meshoptimizer knows neither. For the glTF reader only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace luxel::import {

/// Fills `out` with elements of `stride` bytes, a multiple of 4 up to 256, from a stream of format
/// 1 without its first byte. False: the stream is damaged or holds other elements.
/// [KHR_meshopt_compression, appendix A, "Mode 0: attributes"]
bool decode_attributes(std::span<const uint8_t> stream, size_t stride, std::span<uint8_t> out);

/// Turns elements of 4 bytes, or of 4 numbers of 16 bits where `stride` is 8, from YCoCg into RGBA.
/// [KHR_meshopt_compression, appendix B, "Filter 4: color"]
void decode_colors(size_t stride, std::span<uint8_t> elements);

}  // namespace luxel::import
