// Light that blocks of clusters exchange, as the functions of their clusters or of those of their
// parts see it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/solve/matrix/cluster_functions.h"
#include "luxel/solve/matrix/form_factors.h"

namespace luxel::matrix {

/// C_ab of a block: a of the receiver's functions, b of the sender's.
using Coupling = std::array<Values, kFunctions>;

/// The functions of a patch's cluster, the sum of their squares, and that times the patch's area:
/// what sums over a row's entries are made of.
using SenderValues = std::array<float, 8>;

/// Data that couplings are made of.
struct CouplingSource {
  const FormFactors& factors;
  std::span<const Cluster> clusters;
  std::span<const float> area_m2;
  float rays_per_patch = 1;
  ClusterFunctions functions;
  std::vector<std::vector<SenderValues>> sender;  ///< per depth and patch
  std::vector<double> cluster_m2;                 ///< per cluster
  double leaf_m2 = 0;                             ///< of a mean leaf
};
CouplingSource make_coupling_source(const FormFactors& factors, std::span<const Cluster> clusters,
                                    std::span<const Vec3> position, std::span<const float> area_m2,
                                    int rays_per_patch);

/// A block of the matrix: receivers x senders.
struct Block {
  uint32_t receiver = 0, sender = 0;
};

/// A row's entries in a block are those from `begin` to `end` of the row; from `middle` on they
/// belong to the second part of the senders.
struct RowRange {
  uint32_t begin = 0, middle = 0, end = 0;
};
/// The entries of all rows of a block, by searching.
void find_ranges(const CouplingSource& s, const Block& block, std::span<RowRange> ranges);

/// The two parts that a cluster is looked at as: its halves, or itself.
struct Parts {
  std::array<uint32_t, 2> cluster{};
  uint32_t count = 1;
  uint32_t middle = 0;  ///< first patch of the second one
};
Parts parts_of(const CouplingSource& s, uint32_t cluster, bool halves);

/// The couplings of a block, part by part.
struct Coupled {
  std::array<std::array<Coupling, 2>, 2> part{};
  std::array<std::array<uint32_t, 2>, 2> entries{};
  double noise = 0;  ///< expected square of noise in all coefficients
};
/// Reads the block's entries once; sets the middles of `ranges`, which are those of its rows.
Coupled couple(const CouplingSource& s, const Block& block, const Parts& rows, const Parts& columns,
               std::span<RowRange> ranges);

/// The sum of all squares.
double square_sum(const Coupling& c);

/// Energy of a block's entries, and the part of it that the noise of the rays adds.
struct Energy {
  double entries = 0;  ///< sum of S_ij^2 / (A_i A_j)
  double noise = 0;    ///< its expected part
};
Energy energy_of(const CouplingSource& s, const Block& block, std::span<const RowRange> ranges);

/// F_ij of two leaves, kLeafSize rows per sender, into `value` of as many; 0 where there is none.
void near_entries(const CouplingSource& s, const Block& block, std::span<const RowRange> ranges,
                  std::span<float> value);

}  // namespace luxel::matrix
