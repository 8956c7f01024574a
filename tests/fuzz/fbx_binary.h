// Binary .fbx files for the fuzzers, out of text ones: bytes that are changed at random hardly ever
// keep the lengths of the blocks right, and nothing behind them is reached.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace luxel::fuzz {

/// The blocks and values of a text .fbx file in binary; any text gives some. Offsets have 64 bits
/// where the text says 7500 somewhere, else 32. Arrays of an even length are deflated.
std::vector<std::byte> binary_fbx(std::string_view text);

}  // namespace luxel::fuzz
