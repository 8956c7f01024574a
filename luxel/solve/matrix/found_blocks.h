// Blocks of a matrix as they are found, and in the order in which the matrix keeps them.
#pragma once

#include <span>
#include <vector>

#include "luxel/solve/matrix/block_coupling.h"
#include "luxel/solve/matrix/hierarchical.h"

namespace luxel::matrix {

/// A block that passes through its clusters, and what that loses.
struct FarBlock {
  Block block;
  Coupling coupling;
  double lost = 0;   ///< energy that parts of the clusters, or the entries of leaves, see beside
  double noise = 0;  ///< of that, what the noise of the rays is expected to make
};

/// Two leaves whose entries are kept.
struct NearBlock {
  Block block;
  float scale = 0;
  size_t entry = 0;  ///< of FoundBlocks::entries
};

/// Blocks that a task has found.
struct FoundBlocks {
  std::vector<FarBlock> far;
  std::vector<NearBlock> near;
  std::vector<uint8_t> entries;
};

/// Blocks of a task by receivers, then by what they send: the order in which a walk finds them.
void sort_blocks(const CouplingSource& s, FoundBlocks& found);

/// Replaces the blocks of `out` by those of all tasks, receiver by receiver. Each task's are
/// sorted, and no two tasks have blocks of one receiver.
void assemble(const CouplingSource& s, std::span<const FoundBlocks> found, Hierarchical& out);

}  // namespace luxel::matrix
