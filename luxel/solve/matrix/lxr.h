// The .lxr file: a scene prepared for light that moves. docs/format/lxr.md describes it byte by
// byte.
#pragma once

#include <filesystem>

#include "luxel/base/result.h"
#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

/// Another major version cannot be read; a newer minor one has chunks that are skipped. Places of
/// files before 1.2 lie on the surface, where rays do not start: they are lifted on reading.
inline constexpr uint16_t kLxrMajor = 1, kLxrMinor = 2;

/// Equal data gives equal bytes. `data` satisfies check(); writing what does not is a broken
/// contract.
std::vector<std::byte> encode_lxr(const RelightData& data);

/// `name` is the file's, for error sentences. What comes back satisfies check(). Errors: not an
/// .lxr file, another major version, cut off, damaged, data that cannot be right.
Result<RelightData> decode_lxr(std::span<const std::byte> bytes, const std::string& name);

/// Errors: those of decode_lxr, unreadable.
Result<RelightData> read_lxr(const std::filesystem::path& path);

}  // namespace luxel::matrix
