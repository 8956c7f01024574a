#include "pipeline/solver_memory.h"

#include "pipeline/memory.h"

namespace luxel::pipeline {
namespace {

/// What gather and the steps after it need besides the stored hits, per element and per texel of
/// the square: direct light, two maps of irradiance, variances, two radiosity maps; later, when the
/// hits are gone, the lightmap and its encoded files, which take less. Paths need about the same:
/// three results of 12 bytes per element, and less per texel.
constexpr uint64_t kBytesPerElement = 72, kBytesPerSquareTexel = 20;
/// What denoising needs besides: places, planes, what neighbours show, the level of noise.
constexpr uint64_t kDenoiseBytesPerElement = 140;
/// E for five normals and what becomes of it, with --directional.
constexpr uint64_t kDirectionBytesPerElement = 110;
/// With --layers each takes, per element: direct light, that of rays, the solution and its copy,
/// later the lightmap and its files; and a sweep's map, which is five layers wide, per texel.
constexpr uint64_t kLayerBytesPerElement = 48, kLayerMapBytesPerSquareTexel = 64;
/// What the process holds differs from run to run: by this much less than the size that is advised.
constexpr uint64_t kResidentNoiseMb = 8;

std::string size_text(uint64_t bytes) {
  return bytes < 1u << 20 ? fmt::format("{} bytes", bytes) : fmt::format("{}M", bytes >> 20);
}

}  // namespace

uint64_t bytes_besides_hits(const SolveInput& in, const BakeSettings& settings, size_t layers) {
  const uint64_t side = uint64_t(in.map.resolution);
  // What comes after solving: not all of it at once, but most.
  uint64_t per_element = kBytesPerElement;
  if (settings.denoise) per_element += kDenoiseBytesPerElement;
  if (settings.directional != Directional::none) per_element += kDirectionBytesPerElement;
  per_element += layers * kLayerBytesPerElement;
  const uint64_t per_texel = kBytesPerSquareTexel + (layers > 0 ? kLayerMapBytesPerSquareTexel : 0);
  return resident_bytes() + per_element * in.elements.size() + per_texel * side * side;
}

Result<uint64_t> memory_to_spare(const SolveInput& in, const BakeSettings& settings, uint64_t spare,
                                 size_t layers) {
  const uint64_t side = uint64_t(in.map.resolution);
  const uint64_t needed = bytes_besides_hits(in, settings, layers);
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
