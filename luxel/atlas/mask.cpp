#include <algorithm>

#include "luxel/atlas/pack.h"

namespace luxel::atlas {
namespace {

/// Sorts runs and joins those that touch.
void join_runs(std::vector<Span>& runs) {
  std::sort(runs.begin(), runs.end(), [](Span a, Span b) { return a.begin < b.begin; });
  size_t kept = 0;
  for (size_t i = 0; i < runs.size(); ++i)
    if (kept > 0 && runs[i].begin <= runs[kept - 1].end)
      runs[kept - 1].end = std::max(runs[kept - 1].end, runs[i].end);
    else
      runs[kept++] = runs[i];
  runs.resize(kept);
}

void measure(Mask& mask) {
  mask.width = 0;
  mask.texels = 0;
  for (const auto& row : mask.rows)
    for (const Span run : row) {
      mask.width = std::max(mask.width, run.end);
      mask.texels += uint64_t(run.end - run.begin);
    }
  mask.height = int(mask.rows.size());
}

}  // namespace

Mask make_mask(const std::vector<std::array<DVec2, 3>>& texels) {
  Mask mask;
  for (const auto& corners : texels) {
    const UvTriangle t = uv_triangle(corners);
    const Span rows = touched_rows(t);
    if (size_t(rows.end) > mask.rows.size()) mask.rows.resize(size_t(rows.end));
    for (int j = rows.begin; j < rows.end; ++j) {
      const Span run = touched_texels(t, j);
      if (run.empty()) continue;
      auto& row = mask.rows[size_t(j)];
      // Neighbouring triangles come one after the other: most runs extend the last one.
      if (!row.empty() && run.begin <= row.back().end && run.begin >= row.back().begin)
        row.back().end = std::max(row.back().end, run.end);
      else
        row.push_back(run);
    }
  }
  for (auto& row : mask.rows) join_runs(row);
  measure(mask);
  return mask;
}

Mask turned(const Mask& mask) {
  Mask t;
  t.rows.resize(size_t(mask.width));
  t.width = mask.height;
  t.height = mask.width;
  t.texels = mask.texels;
  // Only where a row differs from the one above does a column's run begin or end.
  std::vector<int> begin(size_t(mask.width), -1);
  std::vector<int> edges;
  static const std::vector<Span> kNoRuns;
  for (int j = 0; j <= mask.height; ++j) {
    const auto& above = j > 0 ? mask.rows[size_t(j - 1)] : kNoRuns;
    const auto& here = j < mask.height ? mask.rows[size_t(j)] : kNoRuns;
    edges.clear();
    for (const auto* runs : {&above, &here})
      for (const Span run : *runs) edges.insert(edges.end(), {run.begin, run.end});
    std::sort(edges.begin(), edges.end());
    for (size_t e = 0; e + 1 < edges.size(); e += 2)
      for (int i = edges[e]; i < edges[e + 1]; ++i) {
        int& b = begin[size_t(i)];
        if (b < 0) {
          b = j;
        } else {
          t.rows[size_t(mask.width - 1 - i)].push_back({b, j});
          b = -1;
        }
      }
  }
  return t;
}

}  // namespace luxel::atlas
