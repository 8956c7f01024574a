#include <algorithm>

#include "atlas/pack.h"

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

Mask make_mask(const std::vector<std::array<Dvec2, 3>>& texels) {
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
  for (int j = 0; j < mask.height; ++j)
    for (const Span run : mask.rows[size_t(j)])
      for (int i = run.begin; i < run.end; ++i) {
        auto& row = t.rows[size_t(mask.width - 1 - i)];
        if (!row.empty() && row.back().end == j)
          row.back().end = j + 1;
        else
          row.push_back({j, j + 1});
      }
  measure(t);
  t.width = mask.height;
  return t;
}

}  // namespace luxel::atlas
