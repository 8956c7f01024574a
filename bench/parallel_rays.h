// Hits of parallel rays in a small scene: its triangles are projected along the rays.
//
// Across their direction rays are points, and triangles are triangles in the plane. Three linear
// functions of a ray's place say if it meets a triangle, and a fourth says where.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::bench {

/// Rays that are traced together: 16 packets of 16 at most.
inline constexpr size_t kLane = 16, kParallelRays = kLane * kLane;

using Lanes = std::array<float, kLane>;
using IntLanes = std::array<int32_t, kLane>;

/// Boxes, by axis: the middle and half the size.
struct BoxLanes {
  alignas(64) std::array<Lanes, 3> middle, half;
};

/// Where parallel rays start. Places beyond `count` repeat the last one.
struct RayStarts {
  size_t count = 0;
  alignas(64) std::array<float, kParallelRays> x, y, z;
  BoxLanes boxes;  ///< around each packet
};
/// kParallelRays at most. Those of 16 that follow each other should lie near to each other.
RayStarts ray_starts(std::span<const Vec3> origins);

/// 16 triangles that lie near to each other.
struct TriangleGroup {
  alignas(64) std::array<Lanes, 9> corner;  ///< a.x a.y a.z b.x ... c.z
  std::array<scene::SurfacePoint, kLane> id;
  uint32_t count = 0;
  uint32_t lets_light_through = 0, mirrored = 0;  ///< one bit each
};
/// All triangles of a scene. Meshes that have instances are repeated.
struct TriangleGroups {
  const scene::Scene* scene = nullptr;
  std::vector<TriangleGroup> groups;
  std::vector<BoxLanes> boxes;  ///< of 16 groups each
};
TriangleGroups triangle_groups(const scene::Scene& scene);

/// A group as seen along the rays. Edge functions are positive inside.
struct ProjectedGroup {
  /// Three edge functions and the depth, each a, b and c of a x + b y + c.
  alignas(64) std::array<Lanes, 12> row;
  alignas(64) Lanes left, right, low, high, near, far;
  IntLanes is_seen, faces_away;
  uint32_t group = 0;
};
/// Reused from direction to direction.
struct ParallelBuffers {
  std::vector<ProjectedGroup> seen;
  size_t count = 0;  ///< of them
};

/// hits[i * stride] is what the i-th ray meets first, as RayTracer::closest_hits() says it.
void parallel_hits(const TriangleGroups& triangles, const RayStarts& starts, Vec3 direction,
                   ParallelBuffers& buffers, trace::Hit* hits, size_t stride);

}  // namespace luxel::bench
