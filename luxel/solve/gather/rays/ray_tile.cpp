#include "luxel/solve/gather/rays/ray_tile.h"

#include <algorithm>
#include <cstring>

namespace luxel::gather {

size_t count_of(std::span<const RayEnd> ends, RayEnd end) {
  // Blocks whose count fits in a byte: several dozen are compared and counted in one instruction.
  constexpr size_t kBlock = 128;
  size_t out = 0;
  for (; !ends.empty(); ends = ends.subspan(std::min(kBlock, ends.size()))) {
    uint8_t count = 0;
    for (const RayEnd e : ends.first(std::min(kBlock, ends.size()))) count += e == end ? 1 : 0;
    out += count;
  }
  return out;
}

size_t next_of(std::span<const std::byte> bytes, uint8_t value, size_t from) {
  if (from >= bytes.size()) return bytes.size();
  const void* found = std::memchr(bytes.data() + from, value, bytes.size() - from);
  return found ? size_t(static_cast<const std::byte*>(found) - bytes.data()) : bytes.size();
}

size_t next_followed(std::span<const RayEnd> ends, size_t from) {
  return next_of(std::as_bytes(ends), uint8_t(RayEnd::followed), from);
}

}  // namespace luxel::gather
