// Bytes as text. [RFC 4648, section 4]
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace luxel {
inline namespace base {

/// The standard alphabet, padded with '=' to a multiple of four.
std::string base64(std::span<const std::byte> bytes);

/// The bytes of such a text, padded or not. None: it has another character, or one too many.
std::optional<std::vector<std::byte>> from_base64(std::string_view text);

}  // namespace base
}  // namespace luxel
