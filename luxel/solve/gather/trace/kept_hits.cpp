#include "luxel/solve/gather/trace/kept_hits.h"

#include <algorithm>

#include "luxel/base/bytes.h"
#include "luxel/base/digest.h"
#include "luxel/light/kept_light.h"

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

/// The values of elements [begin, end).
template <class Array>
auto part_of(Array& array, size_t per_element, size_t begin, size_t end) {
  return std::span(array).subspan(begin * per_element, (end - begin) * per_element);
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
  for_each_array(hits, [&](const auto& array, size_t) { digest.add(std::span(array)); });
  light::add_to(digest, params.layers), light::add_to(digest, params.followed_layers);
  return {params.parts, digest.value()};
}

KeptEntries keep_tile(const KeptStage& kept, size_t begin, size_t end, const TracedTile& tile,
                      const TracedHits& hits) {
  if (!kept.wants()) return {};
  ByteWriter out;
  out.put_value(tile.rays);
  for_each_array(hits, [&](const auto& array, size_t per_element) {
    out.put(part_of(array, per_element, begin, end));
  });
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
  for_each_array(hits, [&](const auto& array, size_t per_element) {
    const size_t size = part_of(array, per_element, begin, end).size_bytes();
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
  for_each_array(hits, [&](auto& array, size_t per_element) {
    arrays.get(part_of(array, per_element, begin, end));
  });
  out.entries = entries_at_end(kept, part, bytes->size(), tile);
  return out;
}

}  // namespace luxel::gather
