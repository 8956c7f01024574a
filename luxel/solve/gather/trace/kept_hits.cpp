#include "luxel/solve/gather/trace/kept_hits.h"

#include <algorithm>

#include "luxel/base/bytes.h"
#include "luxel/base/digest.h"

namespace luxel::gather {
namespace {

/// Everything that a round of tracing changes per element.
template <class Hits, class Visit>
void for_each_array(Hits& hits, const Visit& visit) {
  visit(hits.samples), visit(hits.last_round), visit(hits.first_round), visit(hits.guided),
      visit(hits.counted);
  visit(hits.escaped), visit(hits.met_back), visit(hits.met_double_sided_back);
  visit(hits.sky), visit(hits.sky_luminance2), visit(hits.sky_first_less_second);
}

KeptEntries entries_at_end(const KeptStage& kept, size_t part, size_t bytes, const HitTile& tile) {
  return {kept.store, {kept.stage, part}, bytes - tile.entries.size() * sizeof(StoredHit)};
}

bool is_sound(const HitTile& tile, uint32_t places) {
  return std::is_sorted(tile.end.begin(), tile.end.end()) &&
         std::all_of(tile.entries.begin(), tile.entries.end(),
                     [&](const StoredHit& hit) { return hit.base() < places; });
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
  for_each_array(hits, [&](const auto& array) { digest.add(std::span(array)); });
  return {params.parts, digest.value()};
}

KeptEntries keep_tile(const KeptStage& kept, size_t begin, size_t end, const TracedTile& tile,
                      const TracedHits& hits) {
  if (!kept.wants()) return {};
  ByteWriter out;
  out.put_value(tile.rays);
  for_each_array(hits,
                 [&](const auto& array) { out.put(std::span(array).subspan(begin, end - begin)); });
  out.put(std::span(tile.rays_met.hits.end));
  out.put(std::span(tile.rays_met.hits.entries));
  const size_t part = begin / kTileElements;
  if (!kept.keep(part, out.bytes)) return {};
  return entries_at_end(kept, part, out.bytes.size(), tile.rays_met.hits);
}

std::optional<FoundTile> find_tile(const KeptStage& kept, size_t begin, size_t end, uint32_t places,
                                   TracedHits& hits) {
  const size_t part = begin / kTileElements;
  const auto bytes = kept.find(part);
  if (!bytes) return std::nullopt;
  FoundTile out;
  ByteReader in{*bytes};
  out.tile.rays = in.get_value<uint64_t>();
  ByteReader arrays = in;
  for_each_array(hits, [&](const auto& array) {
    const size_t size = (end - begin) * sizeof(array[0]);
    in.ok = in.ok && size <= in.bytes.size();
    if (in.ok) in.bytes = in.bytes.subspan(size);
  });
  HitTile& tile = out.tile.rays_met.hits;
  tile.end.resize(end - begin);
  in.get(std::span(tile.end));
  if (!in.ok || in.bytes.size() != size_t(tile.end.back()) * sizeof(StoredHit)) return std::nullopt;
  tile.entries.resize(tile.end.back());
  in.get(std::span(tile.entries));
  if (!is_sound(tile, places)) return std::nullopt;
  for_each_array(hits,
                 [&](auto& array) { arrays.get(std::span(array).subspan(begin, end - begin)); });
  out.entries = entries_at_end(kept, part, bytes->size(), tile);
  return out;
}

}  // namespace luxel::gather
