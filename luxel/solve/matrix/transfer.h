// The light of patches, carried back to the surfaces they stand for.
#pragma once

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/solve/matrix/patches.h"

namespace luxel::matrix {

/// Surface points where light is wanted: of texels, of vertices, any [m; unit normals].
struct SurfacePoints {
  std::span<const Vec3> position, normal;
};

/// A linear map from light per patch to light per point.
struct Transfer {
  std::vector<uint32_t> first;  ///< per point, one extra entry
  std::vector<uint32_t> patch;
  std::vector<float> weight;  ///< those of a point sum to 1, or to its open share if it is covered

  size_t size() const { return first.empty() ? 0 : first.size() - 1; }
};

/// At each point the value of a plane fitted to the patches around it, the nearer ones weighing
/// more [Lancaster81, moving least squares]: constant and linear light is kept, and no border of a
/// voxel shows. Only patches that face the same way and that the point sees take part, so that
/// nothing leaks through a wall or round an edge. A point without any takes the nearest. A covered
/// point (transport::open_share) gets their light through what is open of it. Errors: cancelled.
Result<Transfer> make_transfer(const PatchedScene& patched, const trace::RayTracer& tracer,
                               const SurfacePoints& points, Progress& progress);

/// Light per point, never below zero. Allocates nothing.
void transfer(const Transfer& map, std::span<const Rgb> of_patch, std::span<Rgb> of_point);

}  // namespace luxel::matrix
