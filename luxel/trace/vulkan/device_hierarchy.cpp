#include "luxel/trace/vulkan/device_hierarchy.h"

#include <algorithm>
#include <bit>

#include "luxel/trace/shared_meshes.h"

namespace luxel::trace {
namespace {

/// Drawn triangles have numbers below it: shaders keep both sides of each in a table, whose numbers
/// are below 2^31.
constexpr uint64_t kMostDrawn = uint64_t(1) << 30;

/// A shared mesh: its triangles in its own space, numbered from 0 on.
struct SharedMesh {
  uint32_t mesh = 0;
  std::vector<uint32_t> instances;
  std::vector<DeviceTriangle> triangles;
  Box3 box;
  uint32_t root = 0;  ///< node
};

/// What is stored: before it is sorted.
struct Stored {
  std::vector<DeviceTriangle> in_world;
  std::vector<SharedMesh> shared;

  size_t size() const {
    size_t out = in_world.size();
    for (const SharedMesh& s : shared) out += s.triangles.size() + 3 * s.instances.size();
    return out;
  }
};

Stored stored_triangles(const scene::Scene& scene, size_t max_flat_triangles) {
  const std::vector<bool> is_shared = shared_meshes(scene, max_flat_triangles);
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  std::vector<uint32_t> place(scene.meshes.size(), scene::kNone);
  Stored out;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    if (!is_shared[instance.mesh] || !can_be_undone(instance.world_from_object)) {
      add_triangles(scene.meshes[instance.mesh], instance.world_from_object, first[i],
                    out.in_world);
      continue;
    }
    uint32_t& there = place[instance.mesh];
    if (there == scene::kNone) {
      there = uint32_t(out.shared.size());
      SharedMesh& mesh = out.shared.emplace_back();
      mesh.mesh = instance.mesh;
      add_triangles(scene.meshes[instance.mesh], {}, first[i], mesh.triangles);
      for (const DeviceTriangle& t : mesh.triangles)
        for (const Vec3 p : {t.a, t.b, t.c}) mesh.box.extend(p);
    }
    out.shared[there].instances.push_back(i);
  }
  // A mesh without triangles has nothing to meet.
  std::erase_if(out.shared, [](const SharedMesh& mesh) { return mesh.triangles.empty(); });
  return out;
}

/// Surfaces that let light through, of all that is stored. Triangles of shared meshes, which have
/// the numbers of their first instance so far, are numbered from 0 on afterwards.
SeeThrough take_see_through(const scene::Scene& scene, Stored& stored) {
  SeeThrough out;
  SeeThroughFinder finder(scene, out);
  finder.find(stored.in_world);
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  for (SharedMesh& mesh : stored.shared) {
    finder.find(mesh.triangles);
    for (DeviceTriangle& t : mesh.triangles) t.number -= first[mesh.instances.front()];
  }
  return out;
}

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
void add_instances(const scene::Scene& scene, const Stored& stored, float margin_m,
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
void place_instances(const scene::Scene& scene, const Stored& stored, size_t in_world,
                     DeviceHierarchy& out) {
  const auto places = uint32_t(out.triangles.size());
  for (size_t k = 0; k < in_world; ++k) {
    DeviceTriangle& t = out.triangles[k];
    if (t.mirrored == kStandsForInstance) t.number = places + 2 * t.number;
  }
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  for (const SharedMesh& mesh : stored.shared)
    for (const uint32_t i : mesh.instances) {
      const DeviceInstance place{inverse_of(scene.instances[i].world_from_object), mesh.root,
                                 first[i], i};
      const auto both = std::bit_cast<std::array<DeviceTriangle, 2>>(place);
      out.triangles.insert(out.triangles.end(), {both[0], both[1]});
    }
}

/// How far from the origin of a mesh's space rays of the scene may begin.
float reach_in(const SharedMesh& mesh, const scene::Scene& scene, const Box3& world) {
  float out = 0;
  for (const uint32_t i : mesh.instances)
    out = std::max(out, reach_of(moved(world, inverse_of(scene.instances[i].world_from_object))));
  return out;
}

}  // namespace

Result<DeviceHierarchy> device_hierarchy(const scene::Scene& scene, HierarchyKind kind,
                                         size_t max_flat_triangles) {
  uint64_t drawn = 0;
  for (const scene::Instance& i : scene.instances) drawn += scene.meshes[i.mesh].triangles.size();
  if (drawn >= kMostDrawn)
    return fail(ErrorCode::unsupported, "rays on the device know at most {} triangles, not {}",
                kMostDrawn - 1, drawn);
  Stored stored = stored_triangles(scene, max_flat_triangles);
  if (stored.size() >= ChildRef::kFirstMask)
    return fail(ErrorCode::unsupported,
                "rays on the device know at most {} triangles that are no copies, not {}",
                ChildRef::kFirstMask - 1, stored.size());
  DeviceHierarchy out;
  out.see_through = take_see_through(scene, stored);
  out.has_instances = !stored.shared.empty();
  const Box3 world = scene::world_bounds(scene);
  const float reach = reach_of(world);
  std::vector<DeviceTriangle> top = std::move(stored.in_world);
  add_instances(scene, stored, 0x1p-20f * reach, top);
  const size_t in_world = top.size();
  append(std::move(top), kind, reach, out);
  for (SharedMesh& mesh : stored.shared)
    mesh.root = append(std::move(mesh.triangles), kind, reach_in(mesh, scene, world), out);
  place_instances(scene, stored, in_world, out);
  return out;
}

}  // namespace luxel::trace
