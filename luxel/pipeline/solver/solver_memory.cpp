#include "luxel/pipeline/solver/solver_memory.h"

#include <algorithm>

#include "luxel/base/process_memory.h"
#include "luxel/pipeline/reuse/bake_cache.h"

namespace luxel::pipeline {
namespace {

// In bytes per element, and per texel of the square where `square` is in the name. They are sums of
// the arrays' sizes; what a process takes was held against them (docs/method/gather.md, memory).

/// Of elements: position and two normals, which gather gives back when all rays are traced.
constexpr uint64_t kPlaces = 36;
/// light::DirectLight, gather::TracedHits and where the hits of each element end.
constexpr uint64_t kDirect = 20, kTraced = 29 + 4;
/// Of these, counts of rays that are done with when it is known which elements are enclosed.
constexpr uint64_t kCounts = 4, kEnclosed = 1;
/// How many samples each element is to have; with rounds how finely lamps were looked at, too.
constexpr uint64_t kTarget = 2, kLevels = 2;
/// gather::Bounced; the guess that sweeps start from, and how far they are from it.
constexpr uint64_t kBounced = 20, kGuess = 24;
/// The map of radiosity. The lightmap that takes its place, and the most that becomes of it at once
/// before files are written.
constexpr uint64_t kSquareMap = 16, kSquareFiles = 38;
/// TexelLight, which outlives the solver.
constexpr uint64_t kLight = 39;
/// With --keep: direct light and its levels a second time, from the bounces on; light a second time
/// and digests of places, until all of it, and where texels lie, is one piece for the file. Lights
/// have layers in each of the two.
constexpr uint64_t kKeptDirect = 22, kKeptLight = kLight + 8, kKeptTexels = 24, kKeptLayer = 12;
/// Where something scatters light through: the place behind each texel.
constexpr uint64_t kBehind = 8;
/// What other solvers leave for each texel, and what they and the steps after them take.
constexpr uint64_t kOther = 72, kSquareOther = 20;
/// What denoising needs besides: places, planes, what neighbours show, the level of noise.
constexpr uint64_t kDenoise = 140;
/// E for five normals and what becomes of it, with --directional.
constexpr uint64_t kDirection = 110;
/// With --layers each takes, per element: direct light, that of rays, the solution and its copy,
/// later the lightmap and its files; and a sweep's map, which is five layers wide, per texel.
constexpr uint64_t kLayer = 48, kSquareLayerMap = 64;
/// What threads work in and allocators hold, 6 to 14 MiB beyond all of the above in scenes of half
/// a million texels, and what differs from run to run: by this much less than the size that is
/// advised.
constexpr uint64_t kResidentNoiseMb = 16;

std::string size_text(uint64_t bytes) {
  return bytes < 1u << 20 ? fmt::format("{} bytes", bytes) : fmt::format("{}M", bytes >> 20);
}

/// What a bake that is kept holds besides, in its bounces and when all is over.
struct KeptBytes {
  uint64_t bouncing = 0, ending = 0;
};
KeptBytes bytes_of_keeping(const SolveInput& in, const BakeSettings& settings, uint64_t n,
                           uint64_t layers) {
  if (!settings.keep || (in.cache && in.cache->found())) return {};
  const uint64_t direct = kKeptDirect + kKeptLayer * layers;
  const uint64_t all = direct + kKeptLight + kKeptLayer * layers;
  return {direct * n, (all + all + kKeptTexels) * n};
}

/// The most that gather holds at a time, hits aside, and that becomes of its light later.
uint64_t bytes_of_gather(const SolveInput& in, const BakeSettings& settings, uint64_t n,
                         uint64_t square, uint64_t layers) {
  const KeptBytes kept = bytes_of_keeping(in, settings, n, layers);
  const bool scatters = !in.elements.transmittance.empty();
  const bool rounds = settings.max_error > 0 || settings.time_budget_s > 0 || in.on_estimate ||
                      (in.cache && in.cache->found());
  const uint64_t given_back = looks_at_places(settings) || in.on_estimate ? 0 : kPlaces * n;
  const uint64_t levels = rounds || settings.keep ? kLevels : 0;
  const uint64_t traced = (kDirect + kTraced + levels) * n;
  const uint64_t bounced = traced +
                           (kBounced + (rounds ? kGuess : 0) + (scatters ? kBehind : 0)) * n +
                           (scatters ? 2 : 1) * kSquareMap * square;
  const uint64_t last = bounced + kEnclosed * n - kCounts * n + kept.bouncing;
  const uint64_t denoised = settings.denoise ? (kLight + kDenoise) * n : 0;
  const uint64_t turned = settings.directional == Directional::none ? 0 : kDirection * n;
  const uint64_t files =
      kLight * n + turned + (kSquareFiles + (scatters ? kSquareMap : 0)) * square + kept.ending;
  return std::max({traced + kTarget * n, rounds ? bounced : 0, last - given_back, denoised,
                   files - given_back});
}

/// Of other solvers; nearly all of what comes after them is counted as if it were there at once.
uint64_t bytes_of_others(const BakeSettings& settings, uint64_t n, uint64_t square) {
  return (kOther + (settings.denoise ? kDenoise : 0) +
          (settings.directional == Directional::none ? 0 : kDirection)) *
             n +
         kSquareOther * square;
}

}  // namespace

bool looks_at_places(const BakeSettings& settings) {
  return settings.denoise || settings.directional != Directional::none || settings.keep;
}

uint64_t bytes_besides_hits(const SolveInput& in, const BakeSettings& settings, size_t layers) {
  const uint64_t n = in.elements.size(), side = uint64_t(in.map.resolution), square = side * side;
  uint64_t bytes = settings.solver == "gather" ? bytes_of_gather(in, settings, n, square, layers)
                                               : bytes_of_others(settings, n, square);
  const uint64_t maps = layers == 0 ? 0 : in.elements.transmittance.empty() ? 1 : 2;
  bytes += layers * kLayer * n + maps * kSquareLayerMap * square;
  return resident_bytes() + bytes;
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
