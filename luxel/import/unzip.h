// Files inside of others. For this room only.
#pragma once

#include <span>

#include "luxel/import/readers.h"

namespace luxel::import {

struct PackedFile {
  std::string name;
  std::vector<std::byte> bytes;
};

/// All files of a zip archive. Errors: damaged, or sizes that deflate cannot reach. [APPNOTE.TXT by
/// PKWARE, sections 4.3.7 to 4.3.16]
Result<std::vector<PackedFile>> unzip(const SourceFile& source);

/// What a stream of deflate without a header holds, as far as it can be read. [RFC 1951]
std::vector<std::byte> inflate_all(std::span<const std::byte> packed);

}  // namespace luxel::import
