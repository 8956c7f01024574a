// Limits on how deep the parts of a file may lie in each other. For this room only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "luxel/import/readers.h"

namespace luxel::import {

/// Assimp calls itself for each block, element or node that lies in another one. Its stack of 8 MB
/// ends between 5,000 and 20,000 of them; files of real scenes have less than a hundred.
inline constexpr size_t kDeepestNesting = 1000;
/// Nodes that Assimp may copy out of others; each copy takes 1.3 kB.
inline constexpr size_t kMostCopies = 1000000;

/// An error when the elements of a .dae file lie in each other more than kDeepestNesting deep.
Status check_nesting(const SourceFile& source);

struct WrongNesting {
  uint32_t part = 0;
  std::string what;  ///< goes on a sentence that begins with the part
};
/// Part 0 holds all others, parts[p] are those that p holds; one that several hold is copied for
/// each. The first part that holds itself, or more than the limits above; none when all is well.
std::optional<WrongNesting> wrong_nesting(const std::vector<std::vector<uint32_t>>& parts);

/// wrong_nesting() of a .dae file's nodes, with those of other places that they instance.
Status check_collada_nodes(const SourceFile& source);

}  // namespace luxel::import
