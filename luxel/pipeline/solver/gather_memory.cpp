#include "luxel/pipeline/solver/gather_memory.h"

#include <algorithm>

#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/solver/gather.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/texels/finishing_memory.h"
#include "luxel/solve/gather/bounce/bounce_layers.h"
#include "luxel/solve/gather/bounce/bounces.h"
#include "luxel/solve/gather/bounce/radiosity_map.h"
#include "luxel/solve/gather/budget/light_errors.h"
#include "luxel/solve/gather/budget/read_check.h"
#include "luxel/solve/gather/gather.h"

namespace luxel::pipeline {
namespace {

// In bytes per element, and per texel of the square where `square` is in the name. They are sums of
// the arrays' sizes, which stand beside the arrays; what a process takes was held against them
// (docs/method/gather.md, memory).

/// The lightmap that takes the place of the radiosity map, and the most that becomes of it at once
/// before files are written.
constexpr uint64_t kSquareFiles = 38;
/// With --keep: direct light and its levels a second time, from the bounces on.
constexpr uint64_t kKeptDirect = light::kDirectBytesPerElement + light::kLevelBytesPerElement;
/// With --keep, when all is over: light a second time, and digests of places.
constexpr uint64_t kKeptLight = kLightBytesPerElement + bytes_per_entry(&KeptBake::places);
/// With --keep: where texels lie, until all is one piece for the file.
constexpr uint64_t kKeptTexels = bytes_per_entry(&atlas::TexelMap::texels);
/// Lights have layers in both kept direct light and kept light.
constexpr uint64_t kKeptLayer = light::kDirectLayerBytesPerElement;

/// Bytes that a bake with --keep holds besides: in its bounces, and when all is over.
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
  const bool keeps_places =
      looks_at_places(settings) || shows || (stores.device && stores.device->is_optional);
  // Places in files were not counted, and need not be given back.
  const bool in_files = mapped_memory_of(in) != nullptr;
  const uint64_t given_back = keeps_places || in_files ? 0 : transport::kPlaceBytesPerElement * n;
  const bool follows = !settings.direct_samples || !settings.supersample;
  const uint64_t levels = rounds || settings.keep || follows ? light::kLevelBytesPerElement : 0;
  const bool adds = gather_params(settings).more_rays && !settings.keep;
  const bool guides =
      adds || (settings.max_error > 0 && settings.error_measure == gather::ErrorMeasure::rms &&
               !settings.keep);
  const uint64_t guide = guides ? gather::kGuideBytesPerElement : 0;
  const uint64_t traced =
      (light::kDirectBytesPerElement + gather::kTracedBytesPerElement + levels + guide) * n -
      (in_files ? gather::kBroughtBytesPerElement * n : 0);
  const uint64_t chosen =
      adds ? traced + gather::kGrainBytesPerElement * n + gather::kRadiosityBytesPerTexel * square
           : 0;
  const uint64_t bounced =
      traced +
      (gather::kBouncedBytesPerElement + (rounds ? gather::kGuessBytesPerElement : 0) +
       (scatters ? gather::kBehindBytesPerElement : 0)) *
          n +
      (scatters ? 2 : 1) * gather::kRadiosityBytesPerTexel * square;
  const uint64_t last = bounced + gather::kEnclosedBytesPerElement * n -
                        gather::kEndCountBytesPerElement * n + kept.bouncing;
  const uint64_t judged =
      traced + (gather::kBouncedBytesPerElement + gather::kJudgedBytesPerElement) * n;
  const uint64_t of_layers = layers > 0 ? sizeof(float) : 0;  // one variance for all of them
  const uint64_t denoised =
      settings.denoise ? (kLightBytesPerElement + kDenoise + of_layers) * n : 0;
  const uint64_t turned = settings.directional == Directional::none ? 0 : kDirection * n;
  const uint64_t files =
      (kLightBytesPerElement - (in_files && !shows ? kPartsBytesPerElement : 0)) * n + turned +
      (kSquareFiles + (scatters ? gather::kRadiosityBytesPerTexel : 0)) * square + kept.ending;
  return std::max({traced + gather::kTargetBytesPerElement * n, chosen, rounds ? bounced : 0,
                   last - given_back, judged - given_back, denoised, files - given_back});
}

}  // namespace

uint64_t bytes_of_gather(const light::TexelScene& in, const BakeSettings& settings,
                         const SolveStores& stores, bool shows, size_t layers) {
  const uint64_t n = in.elements.size(), side = uint64_t(in.map.resolution), square = side * side;
  if (settings.light != LightPart::all) layers = gather::kSourceLayers;
  const uint64_t maps = layers == 0 ? 0 : in.elements.transmittance.empty() ? 1 : 2;
  const uint64_t check =
      settings.bounces == 0
          ? 0
          : gather::check_bytes(gather::check_rays(
                n * uint64_t(settings.samples), settings.max_error > 0, in.elements.reflectance));
  return bytes_of_all_light(in, settings, stores, shows, layers) + check +
         layers * gather::kLayerBytesPerElement * n +
         maps * gather::kLayerMapBytesPerTexel * square;
}

}  // namespace luxel::pipeline
