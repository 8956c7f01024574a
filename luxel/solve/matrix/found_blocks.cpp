#include "luxel/solve/matrix/found_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/parallel.h"

namespace luxel::matrix {
namespace {

/// In 16 bits each of the largest.
Hierarchical::Far quantised(const FarBlock& far) {
  float largest = 0;
  for (const Values& row : far.coupling)
    for (const float v : row) largest = std::max(largest, std::abs(v));
  Hierarchical::Far out{{}, largest / 32767, far.block.sender};
  if (largest > 0)
    for (size_t a = 0; a < kFunctions; ++a)
      for (size_t b = 0; b < kFunctions; ++b)
        out.coefficient[kLanes * b + a] =
            int16_t(std::lround(far.coupling[a][b] / largest * 32767));
  return out;
}

/// Bytes of a near block.
uint32_t entries_of(const CouplingSource& s, const NearBlock& near) {
  return kLeafSize * s.clusters[near.block.sender].size();
}

/// The blocks of a task, at their receivers' places. Receivers belong to one task each.
void place(const CouplingSource& s, const FoundBlocks& found, std::span<const uint32_t> first_entry,
           Hierarchical& out) {
  uint32_t receiver = kNone, next = 0, entry = 0;
  for (const FarBlock& far : found.far) {
    if (far.block.receiver != receiver)
      receiver = far.block.receiver, next = out.first_far[receiver];
    out.far[next++] = quantised(far);
  }
  receiver = kNone;
  for (const NearBlock& near : found.near) {
    if (near.block.receiver != receiver) {
      receiver = near.block.receiver;
      next = out.first_near[receiver], entry = first_entry[receiver];
    }
    out.near[next++] = {near.block.sender, entry, near.scale};
    std::copy_n(found.entries.begin() + std::ptrdiff_t(near.entry), entries_of(s, near),
                out.entries.begin() + std::ptrdiff_t(entry));
    entry += entries_of(s, near);
  }
}

}  // namespace

void sort_blocks(const CouplingSource& s, FoundBlocks& found) {
  const auto before = [&](const auto& a, const auto& b) {
    if (a.block.receiver != b.block.receiver) return a.block.receiver < b.block.receiver;
    return s.clusters[a.block.sender].first < s.clusters[b.block.sender].first;
  };
  std::sort(found.far.begin(), found.far.end(), before);
  std::sort(found.near.begin(), found.near.end(), before);
}

void assemble(const CouplingSource& s, std::span<const FoundBlocks> found, Hierarchical& out) {
  const size_t clusters = s.clusters.size();
  std::vector<uint32_t> first_entry(clusters + 1, 0);
  out.first_far = out.first_near = first_entry;
  for (const FoundBlocks& f : found) {
    for (const FarBlock& far : f.far) ++out.first_far[far.block.receiver + 1];
    for (const NearBlock& near : f.near) {
      ++out.first_near[near.block.receiver + 1];
      first_entry[near.block.receiver + 1] += entries_of(s, near);
    }
  }
  for (std::vector<uint32_t>* first : {&out.first_far, &out.first_near, &first_entry})
    std::partial_sum(first->begin(), first->end(), first->begin());
  out.far.resize(out.first_far.back()), out.near.resize(out.first_near.back());
  out.entries.resize(first_entry.back());
  parallel_for(found.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) place(s, found[k], first_entry, out);
  });
}

}  // namespace luxel::matrix
