#include "luxel/solve/hemicube/weld.h"

#include <bit>
#include <unordered_map>

#include "luxel/base/random.h"

namespace luxel::hemicube {
namespace {

/// 3 degrees and 60.
constexpr float kSameNormal = 0.99863f, kSmoothNormal = 0.5f;

struct PositionHash {
  size_t operator()(const Vec3& p) const {
    // -0 and 0 are the same place.
    const auto bits = [](float v) { return uint64_t(std::bit_cast<uint32_t>(v + 0.0f)); };
    return size_t(hash64(bits(p.x) | bits(p.y) << 32, bits(p.z)));
  }
};

/// A vertex with what tells it from others at the same point.
struct Side {
  uint32_t vertex = 0, material = 0;
  Vec3 normal;
};

struct Welder {
  const scene::Scene& scene;
  Welded out;
  std::vector<std::vector<Side>> sides;  ///< per point

  void add_instance(uint32_t instance) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
    std::unordered_map<Vec3, uint32_t, PositionHash> point_at;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const scene::Triangle3 world = scene::world_triangle(scene, instance, t);
      const std::array<Vec3, 3> corners{world.a, world.b, world.c};
      std::array<uint32_t, 3> vertex{};
      for (uint32_t k = 0; k < 3; ++k) {
        const auto [entry, is_new] =
            point_at.try_emplace(mesh.positions[mesh.triangles[t][k]], uint32_t(out.points.size()));
        if (is_new) out.points.push_back(corners[k]), sides.emplace_back();
        vertex[k] = vertex_of(instance, t, k, entry->second);
      }
      out.vertex.push_back(vertex);
    }
  }

  uint32_t vertex_of(uint32_t instance, uint32_t triangle, uint32_t corner, uint32_t point) {
    const scene::SurfacePoint p{
        instance, triangle, {corner == 1 ? 1.0f : 0, corner == 2 ? 1.0f : 0}};
    const uint32_t material =
        scene.meshes[scene.instances[instance].mesh].triangle_material[triangle];
    const Vec3 front = scene::front_normal(scene, instance, triangle);
    Vec3 normal = scene::shading_normal(scene, p);
    if (dot(normal, front) < kSmoothNormal) normal = front;
    for (const Side& side : sides[point])
      if (side.material == material && dot(side.normal, normal) > kSameNormal) return side.vertex;
    const uint32_t vertex = uint32_t(out.vertices.size());
    sides[point].push_back({vertex, material, normal});
    out.vertices.push_back(p);
    out.point_of.push_back(point);
    return vertex;
  }
};

}  // namespace

Welded weld(const scene::Scene& scene) {
  Welder welder{scene, {}, {}};
  for (uint32_t i = 0; i < scene.instances.size(); ++i) welder.add_instance(i);
  return std::move(welder.out);
}

}  // namespace luxel::hemicube
