#include "luxel/trace/vulkan/stored_triangles.h"

#include "luxel/trace/shared_meshes.h"

namespace luxel::trace {
namespace {

/// Drawn triangles have numbers below it: shaders keep both sides of each in a table, whose numbers
/// are below 2^31.
constexpr uint64_t kMostDrawn = uint64_t(1) << 30;

StoredTriangles take_triangles(const scene::Scene& scene, size_t max_flat_triangles) {
  const std::vector<bool> is_shared = shared_meshes(scene, max_flat_triangles);
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  std::vector<uint32_t> place(scene.meshes.size(), scene::kNone);
  StoredTriangles out;
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

/// Triangles of shared meshes, which have the numbers of their first instance so far, are numbered
/// from 0 on afterwards.
void find_see_through(const scene::Scene& scene, StoredTriangles& stored) {
  SeeThroughFinder finder(scene, stored.see_through);
  finder.find(stored.in_world);
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  for (SharedMesh& mesh : stored.shared) {
    finder.find(mesh.triangles);
    for (DeviceTriangle& t : mesh.triangles) t.number -= first[mesh.instances.front()];
  }
}

}  // namespace

Result<StoredTriangles> stored_triangles(const scene::Scene& scene, size_t max_flat_triangles) {
  uint64_t drawn = 0;
  for (const scene::Instance& i : scene.instances) drawn += scene.meshes[i.mesh].triangles.size();
  if (drawn >= kMostDrawn)
    return fail(ErrorCode::unsupported, "the device can trace rays to at most {} triangles, not {}",
                kMostDrawn - 1, drawn);
  StoredTriangles out = take_triangles(scene, max_flat_triangles);
  size_t size = out.in_world.size();
  for (const SharedMesh& mesh : out.shared)
    size += mesh.triangles.size() + 3 * mesh.instances.size();
  if (size >= ChildRef::kFirstMask)
    return fail(ErrorCode::unsupported,
                "the device can trace rays to at most {} triangles that are not copies, not {}",
                ChildRef::kFirstMask - 1, size);
  find_see_through(scene, out);
  return out;
}

}  // namespace luxel::trace
