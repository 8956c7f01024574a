#include "luxel/solve/hemicube/rows.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/share_out.h"

namespace luxel::hemicube {
namespace {

constexpr uint32_t kMaxStep = 65535;
constexpr double kMaxWeight = 65535;

/// Four floats in one register: R, G, B and nothing.
typedef float Float4 __attribute__((vector_size(16)));

/// The largest number of entries in a row: each pixel sees up to three vertices, no element comes
/// twice, and steps that are too long for one entry take more.
size_t max_row_entries(const Senders& senders, int resolution) {
  const size_t elements = senders.receivers.size();
  const size_t pixels = 3 * size_t(resolution) * size_t(resolution);
  return std::min(elements, 3 * pixels) + elements / kMaxStep + 1;
}

/// Gives all members of the team what each has set of `values`, one per row, for its own tiles.
/// Errors: those of exchange().
template <class... T>
Status give_tiles(const Rows& rows, Progress& progress, std::span<T>... values) {
  const auto for_each = [&](size_t tile, const auto& visit) {
    const size_t begin = tile * kTileElements;
    const size_t count = std::min(kTileElements, rows.scale.size() - begin);
    (visit(std::as_writable_bytes(values.subspan(begin, count))), ...);
  };
  return luxel::exchange(rows.team, rows.own_tiles,
                         {rows.store.tile_count(),
                          [&](size_t tile, ByteWriter& out) {
                            for_each(tile, [&](std::span<std::byte> part) {
                              out.put(std::span<const std::byte>(part));
                            });
                          },
                          [&](size_t tile, uint32_t, ByteReader& in) {
                            for_each(tile, [&](std::span<std::byte> part) { in.get(part); });
                            return in.ok;
                          }},
                         progress);
}

}  // namespace

float append_row(const View& view, RowTile<RowEntry>& tile) {
  float largest = 0;
  double sum = 0;
  for (const float share : view.share) largest = std::max(largest, share), sum += double(share);
  uint64_t weights = 0;
  uint32_t column = 0;
  double owed = 0;  // by the rounding of the ones before
  for (size_t k = 0; k < view.share.size() && largest > 0; ++k) {
    const double exact = double(view.share[k]) / double(largest) * kMaxWeight + owed;
    const double weight = std::min(std::floor(exact + 0.5), kMaxWeight);
    owed = exact - weight;
    if (weight == 0) continue;
    uint32_t step = view.element[k] - column;
    for (; step > kMaxStep; step -= kMaxStep) tile.entries.push_back({uint16_t(kMaxStep), 0});
    tile.entries.push_back({uint16_t(step), uint16_t(weight)});
    column = view.element[k];
    weights += uint64_t(weight);
  }
  tile.end.push_back(uint32_t(tile.entries.size()));
  return weights > 0 ? float(sum / double(weights)) : 0.0f;
}

Result<Rows> make_rows(const Senders& senders, std::span<const Viewpoint> from,
                       const RowParams& params, Progress& progress) {
  const size_t count = from.size();
  LUXEL_TRY(auto store,
            RowStore<RowEntry>::create(
                count, kTileElements, max_row_entries(senders, params.look.resolution),
                params.memory_limit_bytes, params.scratch_folder,
                params.look.team ? TilesInMemory::first_come : TilesInMemory::first_numbers));
  Rows rows{std::move(store), params.look.team, {}, {}, {}, {}, {}, {}, {}};
  rows.scale.resize(count), rows.emitted.resize(count);
  rows.hidden.resize(count), rows.enclosed.resize(count);
  std::vector<RowTile<RowEntry>> open(rows.store.tile_count());
  std::vector<uint8_t> is_own(open.size());
  const auto keep = [&](size_t i, const View& view) -> Status {
    const size_t tile = i / kTileElements;
    rows.scale[i] = append_row(view, open[tile]);
    rows.emitted[i] = view.emitted;
    rows.hidden[i] = is_hidden(view), rows.enclosed[i] = is_enclosed(view);
    if (params.on_view) params.on_view(i, view);
    if (i + 1 != count && (i + 1) % kTileElements != 0) return {};
    is_own[tile] = 1;
    return rows.store.put(tile, std::move(open[tile]));
  };
  LUXEL_TRY(rows.seconds, look(senders, from, params.look, keep, progress));
  for (uint32_t tile = 0; tile < is_own.size(); ++tile)
    if (is_own[tile]) rows.own_tiles.push_back(tile);
  LUXEL_TRY_STATUS(give_tiles(rows, progress, std::span(rows.emitted), std::span(rows.hidden),
                              std::span(rows.enclosed)));
  return rows;
}

Status sweep(const Rows& rows, std::span<const Rgb> source, std::span<const Rgb> radiosity,
             std::span<Rgb> next, Progress& progress) {
  LUXEL_CHECK(source.size() == rows.scale.size() && next.size() == source.size());
  // Radiosities as registers hold them.
  std::vector<Float4> b(radiosity.size());
  for (size_t i = 0; i < b.size(); ++i)
    b[i] = Float4{radiosity[i].x, radiosity[i].y, radiosity[i].z, 0};
  std::mutex mutex;
  Status status;
  parallel_for(rows.own_tiles.size(), 4, [&](size_t begin, size_t end) {
    RowTile<RowEntry> buffer;
    for (size_t own = begin; own < end; ++own) {
      if (progress.cancelled()) return;
      const size_t t = rows.own_tiles[own];
      const auto tile = rows.store.get(t, buffer);
      if (!tile) {
        const std::lock_guard lock(mutex);
        status = Failure{tile.error()};
        return;
      }
      // Each row's columns follow from their steps.
      const RowEntry* entry = (*tile)->entries.data();
      const RowEntry* const first = entry;
      for (size_t k = 0; k < (*tile)->end.size(); ++k) {
        const size_t i = t * kTileElements + k;
        Float4 sum{};
        uint32_t column = 0;
        for (const RowEntry* stop = first + (*tile)->end[k]; entry != stop; ++entry) {
          column += entry->step;
          sum += b[column] * float(entry->weight);
        }
        next[i] = source[i] + Rgb{sum[0], sum[1], sum[2]} * rows.scale[i];
      }
    }
  });
  LUXEL_TRY_STATUS(status);
  LUXEL_TRY_STATUS(stopped(progress));
  return give_tiles(rows, progress, next);
}

}  // namespace luxel::hemicube
