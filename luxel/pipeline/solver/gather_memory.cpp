#include "luxel/pipeline/solver/gather_memory.h"

#include <algorithm>

#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/solver/finishing_memory.h"
#include "luxel/pipeline/solver/memory.h"

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
/// With --layers each takes, per element: direct light, that of rays, the solution and its copy,
/// later the lightmap and its files; and a sweep's map, which is five layers wide, per texel.
constexpr uint64_t kLayer = 48, kSquareLayerMap = 64;
/// What a bake that is kept holds besides, in its bounces and when all is over.
struct KeptBytes {
  uint64_t bouncing = 0, ending = 0;
};
KeptBytes bytes_of_keeping(const SolveStores& stores, const BakeSettings& settings, uint64_t n,
                           uint64_t layers) {
  if (!settings.keep || (stores.cache && stores.cache->found())) return {};
  const uint64_t direct = kKeptDirect + kKeptLayer * layers;
  const uint64_t all = direct + kKeptLight + kKeptLayer * layers;
  return {direct * n, (all + all + kKeptTexels) * n};
}

/// The most that gather holds at a time, hits aside, and that becomes of its light later.
uint64_t bytes_of_all_light(const light::TexelScene& in, const BakeSettings& settings,
                            const SolveStores& stores, bool shows, uint64_t layers) {
  const uint64_t n = in.elements.size(), side = uint64_t(in.map.resolution), square = side * side;
  const KeptBytes kept = bytes_of_keeping(stores, settings, n, layers);
  const bool scatters = !in.elements.transmittance.empty();
  const bool rounds = settings.max_error > 0 || settings.time_budget_s > 0 || shows ||
                      (stores.cache && stores.cache->found());
  const uint64_t given_back = looks_at_places(settings) || shows ? 0 : kPlaces * n;
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

}  // namespace

uint64_t bytes_of_gather(const light::TexelScene& in, const BakeSettings& settings,
                         const SolveStores& stores, bool shows, size_t layers) {
  const uint64_t n = in.elements.size(), side = uint64_t(in.map.resolution), square = side * side;
  const uint64_t maps = layers == 0 ? 0 : in.elements.transmittance.empty() ? 1 : 2;
  return bytes_of_all_light(in, settings, stores, shows, layers) + layers * kLayer * n +
         maps * kSquareLayerMap * square;
}

}  // namespace luxel::pipeline
