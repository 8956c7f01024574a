// SHA-256 [FIPS 180-4, section 6.2]: what a browser compares a page's scripts and styles with.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace luxel {
inline namespace base {

/// The 32 bytes of the text's SHA-256.
std::array<std::byte, 32> sha256(std::string_view text);

}  // namespace base
}  // namespace luxel
