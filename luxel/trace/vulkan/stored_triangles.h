// Triangles of a hierarchy on a device: those of the world, and those of meshes that several
// instances share.
#pragma once

#include "luxel/base/result.h"
#include "luxel/trace/vulkan/see_through.h"

namespace luxel::trace {

/// A shared mesh: its triangles in its own space, numbered from 0 on.
struct SharedMesh {
  uint32_t mesh = 0;
  std::vector<uint32_t> instances;
  std::vector<DeviceTriangle> triangles;
  Box3 box;
};

struct StoredTriangles {
  std::vector<DeviceTriangle> in_world;
  std::vector<SharedMesh> shared;  ///< none without triangles
  SeeThrough see_through;          ///< of all of them
};

/// Meshes are shared as trace::RayTracer shares them. Errors: 2^28 - 1 triangles or more are to be
/// stored, an instance counting for three; 2^30 or more are drawn (ErrorCode::unsupported).
Result<StoredTriangles> stored_triangles(const scene::Scene& scene, size_t max_flat_triangles);

}  // namespace luxel::trace
