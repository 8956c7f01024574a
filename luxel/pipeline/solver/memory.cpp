#include "luxel/pipeline/solver/memory.h"

#include "luxel/base/mapped_memory.h"
#include "luxel/base/process_memory.h"
#include "luxel/pipeline/texels/finishing_memory.h"

namespace luxel::pipeline {
namespace {

/// Bytes per element, and per texel of the square, for other solvers' light and the steps after.
constexpr uint64_t kOther = 72, kSquareOther = 20;
/// Added to the --max-memory that is advised. Threads and allocators hold 6 to 14 MiB beyond all of
/// the above in scenes of half a million texels, and runs differ.
constexpr uint64_t kResidentNoiseMb = 16;

std::string size_text(uint64_t bytes) {
  return bytes < 1u << 20 ? fmt::format("{} bytes", bytes) : fmt::format("{}M", bytes >> 20);
}

}  // namespace

bool looks_at_places(const BakeSettings& settings) {
  return settings.denoise || settings.directional != Directional::none || settings.keep ||
         !settings.shadow_mask.empty() || settings.occlusion_distance_m > 0;
}

const MappedMemory* mapped_memory_of(const light::TexelScene& in) {
  return in.map.texels.get_allocator().memory.get();
}

// Nearly all of what comes after solvers is counted as if it were there at once.
uint64_t bytes_of_light(const light::TexelScene& in, const BakeSettings& settings) {
  const uint64_t n = in.elements.size(), side = uint64_t(in.map.resolution);
  return (kOther + (settings.denoise ? kDenoise : 0) +
          (settings.directional == Directional::none ? 0 : kDirection)) *
             n +
         kSquareOther * side * side;
}

Result<uint64_t> memory_to_spare(const light::TexelScene& in, const BakeSettings& settings,
                                 uint64_t besides, uint64_t spare) {
  const uint64_t side = uint64_t(in.map.resolution);
  const MappedMemory* const files = mapped_memory_of(in);
  if (files) {
    LUXEL_TRY_STATUS(files->trouble());
    files->let_go();
  }
  const uint64_t needed = resident_bytes() + besides + (files ? kMappedPagesBytes : 0);
  const uint64_t smallest_mb = ((needed + spare) >> 20) + 1 + kResidentNoiseMb;
  if (settings.max_memory_bytes == 0) {
    const uint64_t free = available_bytes() / 5 * 4;
    if (resident_bytes() + free >= needed + spare) return resident_bytes() + free - needed;
    return fail(ErrorCode::out_of_memory,
                "{} x {} texels need {}M of memory, more than is free; lower --resolution", side,
                side, smallest_mb);
  }
  if (settings.max_memory_bytes < needed + spare)
    return fail(
        ErrorCode::out_of_memory,
        "--max-memory {} is too small for this scene at {} x {}: the smallest that works is {}M",
        size_text(settings.max_memory_bytes), side, side, smallest_mb);
  return settings.max_memory_bytes - needed;
}

}  // namespace luxel::pipeline
