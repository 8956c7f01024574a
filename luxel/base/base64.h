// Bytes as text. [RFC 4648, section 4]
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace luxel {
inline namespace base {

/// The standard alphabet, padded with '=' to a multiple of four.
std::string base64(std::span<const std::byte> bytes);

}  // namespace base
}  // namespace luxel
