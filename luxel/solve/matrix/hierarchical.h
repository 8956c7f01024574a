// The matrix of form factors in a hierarchy: groups of patches exchange light with distant groups
// through a few numbers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/cluster_tree.h"
#include "luxel/solve/matrix/form_factors.h"

namespace luxel::matrix {

/// Functions per cluster: 1 and the two widest of x, y, z over its patches, made orthonormal
/// (weighted by area); fewer where patches lie in a line. Light varies along a surface: what varies
/// across it is another direction's cluster.
inline constexpr uint32_t kFunctions = 3;
/// Vectors of functions are padded to this.
inline constexpr uint32_t kLanes = 4;

/// S_ij = A_i F_ij as an H^2-matrix [Hackbusch02]: of blocks of clusters (s, t)
///   far:   sum_ab A_i phi_a(i) C_ab phi_b(j) A_j,
///   near:  the entries themselves.
/// phi of a cluster are combinations of those of its halves, so E = F B takes one pass up the tree
/// (moments of B), one over the blocks, and one down. Patches are in the order of the tree.
struct Hierarchical {
  struct Far {
    std::array<int16_t, kLanes * kFunctions> coefficient{};
    float scale = 0;      ///< C_ab = scale * coefficient[kLanes * b + a], a the receiver's function
    uint32_t sender = 0;  ///< cluster
  };
  struct Near {
    uint32_t sender = 0;  ///< a leaf
    uint32_t entry = 0;   ///< the first of size(sender) columns of kLeafSize entries
    float scale = 0;      ///< F_ij = scale * entry, i the receiver
  };
  /// Functions of the parent in terms of its half's: up[kLanes * b + a], a the parent's.
  using Up = std::array<float, kLanes * kFunctions>;

  std::vector<Cluster> clusters;
  std::vector<Up> up;                              ///< per cluster, to its parent
  std::vector<std::array<float, kFunctions>> phi;  ///< per patch, those of its leaf
  std::vector<float> area_m2;                      ///< per patch
  std::vector<uint32_t> first_far;                 ///< per cluster, one extra entry
  std::vector<Far> far;                            ///< receiver by receiver
  std::vector<uint32_t> first_near;                ///< per cluster, one extra entry
  std::vector<Near> near;                          ///< receiver by receiver
  std::vector<uint8_t> entries;

  size_t size() const { return area_m2.size(); }
};

struct HierarchicalParams {
  /// A block passes through its clusters when what that loses, in the norm in which all light of a
  /// cluster is 1, is below this, or less than `noise` times what the noise of the rays makes of
  /// it.
  float block_error = 0.003f;
  int rays_per_patch = 2048;  ///< that `factors` were made with: their noise
  float noise = 0.25f;
};

/// `factors` are reciprocal, in the order of `tree` (whose `order` is 0, 1, 2, ...). Errors:
/// cancelled.
Result<Hierarchical> compress(const FormFactors& factors, const ClusterTree& tree,
                              std::span<const Vec3> position, std::span<const float> area_m2,
                              const HierarchicalParams& params, Progress& progress);

/// compress() again and again, each time with a smaller loss: only the blocks that now lose too
/// much are looked at again, so that all steps together take little more than the last one alone.
class Compression {
 public:
  /// As for compress(). What is passed must outlive it.
  Compression(const FormFactors& factors, const ClusterTree& tree, std::span<const Vec3> position,
              std::span<const float> area_m2, int rays_per_patch);
  ~Compression();
  Compression(const Compression&) = delete;
  Compression& operator=(const Compression&) = delete;

  /// The result of compress(), to the bit. params.block_error and params.noise are no larger than
  /// at the step before, params.rays_per_patch is not looked at. Errors: cancelled, after which
  /// there are no more steps.
  Result<Hierarchical> step(const HierarchicalParams& params, Progress& progress);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Moments of a cluster's light, channel by channel.
using Moments = std::array<float, 3 * kLanes>;
/// As many lanes as a far block has 16-bit words.
inline constexpr uint32_t kWords = 16;
static_assert(sizeof(Hierarchical::Far) == 2 * kWords);
/// Moments as far blocks read them: channel by channel each kLanes times, then zeros.
using SpreadMoments = std::array<float, 3 * kWords>;

/// Room for one product.
struct HierarchicalScratch {
  std::vector<Moments> sent, received;  ///< per cluster
  std::vector<SpreadMoments> spread;    ///< per cluster
};
/// Allocates for one product at a time.
HierarchicalScratch make_scratch(const Hierarchical& matrix);

/// E = F B. Allocates nothing.
void multiply(const Hierarchical& matrix, std::span<const Rgb> radiosity, std::span<Rgb> irradiance,
              HierarchicalScratch& scratch);

/// Bytes of clusters, functions and blocks.
uint64_t bytes_of(const Hierarchical& matrix);

}  // namespace luxel::matrix
