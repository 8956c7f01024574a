#include "luxel/trace/vulkan/device_hierarchy.h"

#include <algorithm>
#include <bit>
#include <span>

#include "luxel/base/check.h"
#include "luxel/trace/vulkan/stored_triangles.h"

namespace luxel::trace {
namespace {

/// The inverse of an invertible transform.
Mat34 inverse_of(const Mat34& m) {
  const Vec3 x = column(m, 0), y = column(m, 1), z = column(m, 2), t = column(m, 3);
  const float inverse_det = 1 / dot(x, cross(y, z));
  const Vec3 rows[3] = {cross(y, z) * inverse_det, cross(z, x) * inverse_det,
                        cross(x, y) * inverse_det};
  Mat34 out;
  for (size_t k = 0; k < 3; ++k) out.row[k] = {rows[k].x, rows[k].y, rows[k].z, -dot(rows[k], t)};
  return out;
}

/// The box around a box that stands so.
Box3 moved(const Box3& box, const Mat34& m) {
  Box3 out;
  for (int corner = 0; corner < 8; ++corner)
    out.extend(transform_point(
        m, {corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
            corner & 4 ? box.upper.z : box.lower.z}));
  return out;
}

/// Sorts triangles and appends nodes and triangles to the hierarchy. Returns the root. `reach`: how
/// far from the origin of their space rays may begin.
uint32_t append(std::vector<DeviceTriangle> triangles, HierarchyKind kind, float reach,
                DeviceHierarchy& out) {
  const auto first_triangle = uint32_t(out.triangles.size());
  const auto take = [&](const std::vector<DeviceTriangle>& sorted) {
    out.triangles.insert(out.triangles.end(), sorted.begin(), sorted.end());
  };
  if (kind == HierarchyKind::wide) {
    const auto root = uint32_t(out.wide.size());
    WideHierarchy wide =
        widen(sort_into_hierarchy(std::move(triangles), WideNode::kMostInLeaf), reach);
    for (WideNode node : wide.nodes) {
      node.first_node += root, node.first_triangle += first_triangle;
      out.wide.push_back(node);
    }
    take(wide.triangles);
    return root;
  }
  const auto root = uint32_t(out.binary.size());
  BinaryHierarchy binary = sort_into_hierarchy(std::move(triangles));
  const auto moved_ref = [&](uint32_t ref) {
    return ChildRef::is_leaf(ref)
               ? ChildRef::leaf(ChildRef::first(ref) + first_triangle, ChildRef::count(ref))
               : ref + root;
  };
  for (BinaryNode node : binary.nodes) {
    node.child0 = moved_ref(node.child0), node.child1 = moved_ref(node.child1);
    out.binary.push_back(node);
  }
  take(binary.triangles);
  return root;
}

/// Triangles that stand for the instances of shared meshes, numbered from 0 on.
void add_instances(const scene::Scene& scene, const StoredTriangles& stored, float margin_m,
                   std::vector<DeviceTriangle>& out) {
  uint32_t number = 0;
  const Vec3 margin{margin_m, margin_m, margin_m};
  for (const SharedMesh& mesh : stored.shared)
    for (const uint32_t i : mesh.instances) {
      const Box3 box = moved(mesh.box, scene.instances[i].world_from_object);
      out.push_back(
          {box.lower - margin, number++, box.upper + margin, kStandsForInstance, box.centre(), 0});
    }
}

/// The places of instances, behind all triangles; those that stand for them get to know where.
void place_instances(const scene::Scene& scene, const StoredTriangles& stored, size_t in_world,
                     std::span<const uint32_t> roots, DeviceHierarchy& out) {
  const auto places = uint32_t(out.triangles.size());
  for (size_t k = 0; k < in_world; ++k) {
    DeviceTriangle& t = out.triangles[k];
    if (t.mirrored == kStandsForInstance) t.number = places + 2 * t.number;
  }
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  for (size_t m = 0; m < stored.shared.size(); ++m)
    for (const uint32_t i : stored.shared[m].instances) {
      const DeviceInstance place{inverse_of(scene.instances[i].world_from_object), roots[m],
                                 first[i], i};
      const auto both = std::bit_cast<std::array<DeviceTriangle, 2>>(place);
      out.triangles.insert(out.triangles.end(), {both[0], both[1]});
    }
}

/// Reach of the scene's rays in a mesh's space, the largest over its instances.
float reach_in(const SharedMesh& mesh, const scene::Scene& scene, const Box3& world) {
  float out = 0;
  for (const uint32_t i : mesh.instances)
    out = std::max(out, reach_of(moved(world, inverse_of(scene.instances[i].world_from_object))));
  return out;
}

}  // namespace

std::string_view name_of(HierarchyKind kind) {
  constexpr std::string_view kNames[] = {"binary", "wide", "driver"};
  return kNames[size_t(kind)];
}

Result<DeviceHierarchy> device_hierarchy(const scene::Scene& scene, HierarchyKind kind,
                                         size_t max_flat_triangles) {
  LUXEL_CHECK(kind != HierarchyKind::driver);
  LUXEL_TRY(StoredTriangles stored, stored_triangles(scene, max_flat_triangles));
  DeviceHierarchy out;
  out.see_through = std::move(stored.see_through);
  out.has_instances = !stored.shared.empty();
  const Box3 world = scene::world_bounds(scene);
  const float reach = reach_of(world);
  std::vector<DeviceTriangle> top = std::move(stored.in_world);
  add_instances(scene, stored, 0x1p-20f * reach, top);
  const size_t in_world = top.size();
  append(std::move(top), kind, reach, out);
  std::vector<uint32_t> roots;
  for (SharedMesh& mesh : stored.shared)
    roots.push_back(append(std::move(mesh.triangles), kind, reach_in(mesh, scene, world), out));
  place_instances(scene, stored, in_world, roots, out);
  return out;
}

}  // namespace luxel::trace
