#include "luxel/atlas/mask.h"

#include <algorithm>

namespace luxel::atlas {
namespace {

/// Joins each run with the one before where they touch; returns how many are left.
size_t join_neighbours(std::span<Span> runs) {
  size_t kept = 0;
  for (const Span run : runs)
    if (kept > 0 && run.begin <= runs[kept - 1].end && run.end >= runs[kept - 1].begin)
      runs[kept - 1] = {std::min(runs[kept - 1].begin, run.begin),
                        std::max(runs[kept - 1].end, run.end)};
    else
      runs[kept++] = run;
  return kept;
}

/// Sorts runs and joins those that touch; returns how many are left.
size_t join_runs(std::span<Span> runs) {
  // Neighbouring triangles come one after the other: that leaves few to sort.
  runs = runs.first(join_neighbours(runs));
  if (runs.size() <= 1) return runs.size();
  std::sort(runs.begin(), runs.end(), [](Span a, Span b) { return a.begin < b.begin; });
  return join_neighbours(runs);
}

/// Joins the runs of each row, and counts their texels.
void finish(Mask& mask) {
  uint32_t kept = 0, begin = 0;
  for (int j = 0; j < mask.height; ++j) {
    const uint32_t end = mask.first_run[size_t(j) + 1];
    Span* row = mask.runs.data() + begin;
    const size_t count = join_runs({row, end - begin});
    std::copy(row, row + count, mask.runs.data() + kept);
    mask.first_run[size_t(j)] = kept;
    kept += uint32_t(count);
    begin = end;
  }
  mask.first_run[size_t(mask.height)] = kept;
  mask.runs.resize(kept);
  for (const Span run : mask.runs) mask.texels += uint64_t(run.end - run.begin);
}

}  // namespace

Mask mask_of(int width, int height, std::span<const RowRun> runs) {
  Mask mask{width, height, {}, {}, 0};
  // Counted per row, each run has a place of its own.
  mask.first_run.resize(size_t(height) + 1);
  for (const RowRun& run : runs) ++mask.first_run[size_t(run.row)];
  uint32_t end = 0;
  for (uint32_t& first : mask.first_run) first = end += first;
  mask.runs.resize(runs.size());
  for (size_t r = runs.size(); r-- > 0;)
    mask.runs[--mask.first_run[size_t(runs[r].row)]] = runs[r].columns;
  finish(mask);
  return mask;
}

Mask make_mask(const std::vector<std::array<DVec2, 3>>& texels) {
  std::vector<RowRun> runs;
  runs.reserve(64);
  int width = 0, height = 0;
  for (const auto& corners : texels) {
    const UvTriangle t = uv_triangle(corners);
    const Span rows = touched_rows(t);
    height = std::max(height, rows.end);
    for (int j = rows.begin; j < rows.end; ++j) {
      const Span columns = touched_texels(t, j);
      if (columns.empty()) continue;
      width = std::max(width, columns.end);
      runs.push_back({j, columns});
    }
  }
  return mask_of(width, height, runs);
}

Mask turned(const Mask& mask) {
  std::vector<RowRun> runs;
  // Only where a row differs from the one above does a column's run begin or end.
  std::vector<int> begin(size_t(mask.width), -1);
  std::vector<int> edges;
  for (int j = 0; j <= mask.height; ++j) {
    const std::span<const Span> above = j > 0 ? mask.row(j - 1) : std::span<const Span>();
    const std::span<const Span> here = j < mask.height ? mask.row(j) : std::span<const Span>();
    if (std::ranges::equal(above, here)) continue;
    edges.clear();
    for (const auto& runs_of_row : {above, here})
      for (const Span run : runs_of_row) edges.insert(edges.end(), {run.begin, run.end});
    std::sort(edges.begin(), edges.end());
    for (size_t e = 0; e + 1 < edges.size(); e += 2)
      for (int i = edges[e]; i < edges[e + 1]; ++i) {
        int& b = begin[size_t(i)];
        if (b >= 0) runs.push_back({mask.width - 1 - i, {b, j}});
        b = b < 0 ? j : -1;
      }
  }
  return mask_of(mask.height, mask.width, runs);
}

Mask widened(const Mask& mask, int gutter) {
  std::vector<RowRun> runs;
  runs.reserve(mask.runs.size() * size_t(2 * gutter + 1));
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.row(j))
      for (int down = 0; down <= 2 * gutter; ++down)
        runs.push_back({j + down, {run.begin, run.end + 2 * gutter}});
  return mask_of(mask.width + 2 * gutter, mask.height + 2 * gutter, runs);
}

}  // namespace luxel::atlas
