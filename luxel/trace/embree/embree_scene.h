// A scene as Embree has it.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <vector>

#include "luxel/scene/sides.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::trace {

/// Up to so many triangles packets of rays that are only alike run faster as coherent ones. At
/// 6,000 both are as fast, and in larger scenes coherent ones are up to a sixth slower.
inline constexpr size_t kFewTriangles = 4096;
/// From so many rays over a hemisphere on those of a packet are alike enough. Measured on an AMD
/// EPYC (AVX2): packets of 8 out of 64 rays are up to an eighth slower as coherent ones, and out of
/// 128 rays up to a fifth faster. On an Intel Xeon (AVX-512) packets of 16 out of 64 are faster.
inline constexpr size_t kAlikeOfPacket8 = 128, kAlikeOfPacket16 = 64;

struct RayTracer::Impl {
  const scene::Scene* scene = nullptr;
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshes;   ///< per mesh; null: its instances lie in the top level themselves
  bool has_wide_vectors = false;  ///< of 16 numbers (AVX-512): packets have as many rays, else 8
  bool has_shared_meshes = false;
  bool has_tints = false;
  size_t sorted_triangles = 0;

  /// True: the packets of a batch of so many rays are traced as coherent ones.
  bool is_coherent(Packets packets, size_t rays) const {
    if (has_shared_meshes || packets == Packets::any) return false;
    if (packets == Packets::bundles) return true;
    return rays >= (has_wide_vectors ? kAlikeOfPacket16 : kAlikeOfPacket8) &&
           sorted_triangles <= kFewTriangles;
  }
  /// Per instance, the map of object normals to world normals of the front side.
  std::vector<std::array<Vec3, 3>> normal_columns;

  ~Impl() {
    for (RTCScene mesh : meshes)
      if (mesh) rtcReleaseScene(mesh);
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }

  RTCGeometry new_triangles(const scene::Mesh& mesh, const Mat34& map);
  bool add_shared_mesh(const scene::Mesh& mesh);
  bool add_instance(uint32_t instance);
  bool add_top();
  bool from_behind(uint32_t instance, Vec3 object_normal, Vec3 direction) const {
    const auto& m = normal_columns[instance];
    const Vec3 n = m[0] * object_normal.x + m[1] * object_normal.y + m[2] * object_normal.z;
    return dot(n, direction) > 0;
  }
  /// Moves a hit on the back of a two-sided surface to the side that the ray comes from.
  void turn_to_ray(Hit& hit) const {
    if (!hit.back_face) return;
    if (const auto other = scene::other_side_of(*scene, hit.point()))
      hit.triangle = other->triangle, hit.at = other->at, hit.back_face = false;
  }
};

}  // namespace luxel::trace
