// Views of all elements, kept so that all passes after the first are sums without a new ray.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "luxel/base/row_store.h"
#include "luxel/solve/hemicube/look.h"

namespace luxel::hemicube {

/// A form factor in four bytes: `step` columns on from the entry before (the first from column 0),
/// weight times the row's scale. Longer ways take entries of weight 0.
struct RowEntry {
  uint16_t step = 0, weight = 0;
};
static_assert(sizeof(RowEntry) == 4);

/// A matrix of form factors, a row per viewpoint and a column per sender. A factor errs by about
/// 1/65535 of the row's largest one at most; the sum of a row is exact, and that of neighbours errs
/// no more than one of them: what rounding takes from one the next gets, so that many small factors
/// do not vanish.
struct Rows {
  RowStore<RowEntry> store;
  /// Whose members have rows: each those of its tiles of kTileElements. Null: all are here.
  Team* team = nullptr;
  std::vector<uint32_t> own_tiles{};
  std::vector<float> scale;       ///< per row that is here
  std::vector<Rgb> emitted;       ///< per row: irradiance from emission and background
  std::vector<uint8_t> hidden;    ///< per row: 1 inside a solid
  std::vector<uint8_t> enclosed;  ///< per row: 1 where is_enclosed
  std::vector<uint8_t> covered;  ///< per row: 1 where something much closer than elements covers it
  LookSeconds seconds;
};

/// Appends a row to a tile; returns its scale.
float append_row(const View& view, RowTile<RowEntry>& tile);

struct RowParams {
  LookParams look;
  uint64_t memory_limit_bytes = UINT64_MAX;  ///< the rest goes to a temporary file
  std::filesystem::path scratch_folder = ".";
  /// Gets every view, by the number of its row, from many threads; nothing where nobody does.
  std::function<void(size_t, const View&)> on_view{};
};

/// Looks from every viewpoint at all senders, of which the members of params.look.team have a part
/// each. Errors: cancelled, disk full, another member of the team gives up.
Result<Rows> make_rows(const Senders& senders, std::span<const Viewpoint> from,
                       const RowParams& params, Progress& progress);

/// next_i = source_i + sum_j F_ij radiosity_j; radiosity is per sender, the others per row. Errors:
/// cancelled; the file cannot be read; another member of the team gives up.
Status sweep(const Rows& rows, std::span<const Rgb> source, std::span<const Rgb> radiosity,
             std::span<Rgb> next, Progress& progress);

}  // namespace luxel::hemicube
