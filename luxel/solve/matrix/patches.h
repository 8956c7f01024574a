// The scene in a few thousand patches: what exchanges light. [Shcherbakov17, section 3.2]
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/solve/matrix/cluster_tree.h"
#include "luxel/solve/matrix/patch_locator.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/transport/elements.h"

namespace luxel::matrix {

inline constexpr size_t kMaxPatches = 1u << 20;

/// Settings by which surfaces are divided.
struct PatchParams {
  size_t count = 8192;        ///< about so many
  int points_per_patch = 48;  ///< on average: they are what a patch is made of
  uint64_t seed = 1;
  /// Per mesh, one flag per triangle: 1 where light gets behind a double-sided one. Other backs lie
  /// inside closed solids and are left out; a mesh without flags has none. Nothing: all backs have
  /// points.
  std::optional<std::vector<std::vector<uint8_t>>> open_backs = {};
};

/// Pieces of surface, each of one material, nearly flat, of about the same size, and such that its
/// parts see each other: the two sides of a wall (of a double-sided surface, too), or the floors on
/// both sides of it, are different patches.
struct Patches {
  /// Middle of each patch (on the surface, the point nearest to its centroid), mean normal, mean
  /// reflectance.
  transport::Elements elements;
  std::vector<Vec3> centroid;  ///< mean position, maybe off the surface [m]
  std::vector<float> area_m2;
  std::vector<Rgb> emission;          ///< mean radiosity of its own, B_e = pi L [W/m^2]
  std::vector<uint32_t> material;     ///< of the scene
  std::vector<uint32_t> first_point;  ///< per patch, one extra entry: its part of `points`
  std::vector<PatchPoint> points;     ///< spread evenly over the patches
  float voxel_m = 0;                  ///< edge of the voxels that surfaces were cut by

  /// The number of patches.
  size_t size() const { return area_m2.size(); }
  /// The points that a patch is made of.
  std::span<const PatchPoint> points_of(size_t patch) const {
    return {points.data() + first_point[patch], first_point[patch + 1] - first_point[patch]};
  }
  /// Where its direct light is taken: of at most kProbes points, spread over the patch, the k-th.
  size_t probes_of(size_t patch) const { return std::min(points_of(patch).size(), kProbes); }
  /// The k-th of probes_of(patch) points at which direct light is taken.
  const PatchPoint& probe(size_t patch, size_t k) const {
    const auto all = points_of(patch);
    return all[k * all.size() / probes_of(patch)];
  }
  static constexpr size_t kProbes = 8;
};

/// Leaves of the tree over the patches.
inline constexpr uint32_t kLeafSize = 8;

/// A scene cut into patches, and what finds them: clusters by place and direction, rays by what
/// they meet.
struct PatchedScene {
  Patches patches;  ///< in the order of the tree
  ClusterTree tree;
  PatchLocator locator;
  /// As in PatchParams: other backs have no patches.
  std::optional<std::vector<std::vector<uint8_t>>> open_backs;
};

/// The patch that a ray meets; kNone on sides that have none: backs of one-sided surfaces, those of
/// closed solids, and what is covered.
uint32_t patch_met(const PatchedScene& patched, const scene::Scene& scene,
                   const trace::RayTracer& tracer, const trace::Hit& hit);

/// Spreads points over the scene's surfaces, groups them by voxel, material and direction, splits
/// groups whose points do not see each other, and merges slivers into neighbours. The voxels are as
/// large as gives about params.count patches. Errors: no surface, bad count, cancelled.
Result<PatchedScene> make_patches(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  const PatchParams& params, Progress& progress);

}  // namespace luxel::matrix
