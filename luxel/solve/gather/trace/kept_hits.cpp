#include "luxel/solve/gather/trace/kept_hits.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/bytes.h"
#include "luxel/base/digest.h"
#include "luxel/light/kept_light.h"
#include "luxel/solve/gather/rays/own_tiles.h"

namespace luxel::gather {
namespace {

/// Everything that a round of tracing changes per element: visit(array, values per element).
template <class Hits, class Visit>
void for_each_array(Hits& hits, const Visit& visit) {
  visit(hits.samples, 1), visit(hits.last_round, 1), visit(hits.first_round, 1);
  visit(hits.guided, 1), visit(hits.counted, 1);
  visit(hits.escaped, 1), visit(hits.met_back, 1), visit(hits.met_double_sided_back, 1);
  visit(hits.sky, 1), visit(hits.sky_luminance2, 1), visit(hits.sky_first_less_second, 1);
  visit(hits.sky_by_layer, hits.sky_by_layer.size() / std::max<size_t>(hits.size(), 1));
}

KeptEntries entries_at_end(const KeptStage& kept, size_t part, size_t bytes, const HitTile& tile) {
  return {kept.store, {kept.stage, part}, bytes - tile.entries.size() * sizeof(StoredHit)};
}

bool is_sound(const HitTile& tile, uint32_t places) {
  return std::is_sorted(tile.end.begin(), tile.end.end()) &&
         std::all_of(tile.entries.begin(), tile.entries.end(),
                     [&](const StoredHit& hit) { return hit.base() < places; });
}

/// True: a round can have made `found` of elements [begin, end) of `hits`. Later stages index by
/// it, and files of parts come from other machines.
bool can_follow(const TracedHits& hits, const TracedHits& found, std::span<const uint16_t> target,
                size_t begin, size_t end) {
  const size_t round = hits.rounds.size();
  for (size_t i = begin, k = 0; i < end; ++i, ++k) {
    const bool is_new = target[i] > hits.samples[i];
    const bool is_counted = found.samples[k] == std::max(hits.samples[i], target[i]) &&
                            found.last_round[k] == (is_new ? round : hits.last_round[i]) &&
                            found.first_round[k] == hits.first_round[i] &&
                            found.guided[k] == hits.guided[i];
    const bool is_light = is_finite(found.sky[k]) && std::isfinite(found.sky_luminance2[k]) &&
                          std::isfinite(found.sky_first_less_second[k]);
    if (!is_counted || !is_light) return false;
  }
  return std::ranges::all_of(found.sky_by_layer, [](Rgb l) { return is_finite(l); });
}

}  // namespace

KeptStage kept_round(const TracedHits& hits, std::span<const uint16_t> target,
                     const TraceParams& params) {
  if (params.parts == nullptr) return {};
  Digest digest;
  digest.add("trace rays"), digest.add(params.seed), digest.add(params.follows_near);
  digest.add(hits.rounds.size()), digest.add(target);
  digest.add(std::span(hits.guide.of_element));
  for (const GuidedGroup& group : hits.guide.groups)
    digest.add(std::span<const float>(group.doublings));
  for_each_array(hits, [&](const auto& array, size_t) { digest.add(std::span(array)); });
  light::add_to(digest, params.layers), light::add_to(digest, params.followed_layers);
  return {params.parts, digest.value()};
}

void put_counts(const TracedHits& hits, size_t tile, ByteWriter& out) {
  for_each_array(hits, [&](const auto& array, size_t per_element) {
    out.put(of_tile(std::span(array), tile, hits.size(), per_element));
  });
}

bool get_counts(ByteReader& in, size_t tile, TracedHits& hits) {
  for_each_array(hits, [&](auto& array, size_t per_element) {
    in.get(of_tile(std::span(array), tile, hits.size(), per_element));
  });
  return in.ok;
}

KeptEntries keep_tile(const KeptStage& kept, size_t part, const TracedTile& tile,
                      const TracedHits& hits) {
  if (!kept.wants()) return {};
  ByteWriter out;
  out.put_value(tile.rays);
  put_counts(hits, part, out);
  out.put(std::span(tile.rays_met.hits.end));
  out.put(std::span(tile.rays_met.hits.entries));
  if (!kept.keep(part, out.bytes)) return {};
  return entries_at_end(kept, part, out.bytes.size(), tile.rays_met.hits);
}

std::optional<FoundTile> find_tile(const KeptStage& kept, size_t begin, size_t end, uint32_t places,
                                   std::span<const uint16_t> target, TracedHits& hits) {
  const size_t part = begin / kTileElements;
  const auto bytes = kept.find(part);
  if (!bytes) return std::nullopt;
  FoundTile out;
  ByteReader in{*bytes};
  out.tile.rays = in.get_value<uint64_t>();
  const size_t layers = hits.sky_by_layer.size() / std::max<size_t>(hits.size(), 1);
  TracedHits counted = no_hits(end - begin, layers);
  for_each_array(counted, [&](auto& array, size_t) { in.get(std::span(array)); });
  HitTile& tile = out.tile.rays_met.hits;
  tile.end.resize(end - begin);
  in.get(std::span(tile.end));
  if (!in.ok || in.bytes.size() != size_t(tile.end.back()) * sizeof(StoredHit)) return std::nullopt;
  tile.entries.resize(tile.end.back());
  in.get(std::span(tile.entries));
  if (!is_sound(tile, places) || !can_follow(hits, counted, target, begin, end))
    return std::nullopt;
  ByteReader arrays{std::span(*bytes).subspan(sizeof(uint64_t))};
  get_counts(arrays, part, hits);
  out.entries = entries_at_end(kept, part, bytes->size(), tile);
  return out;
}

}  // namespace luxel::gather
