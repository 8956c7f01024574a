#include "luxel/solve/hierarchical/faces.h"

#include <algorithm>

#include <map>

#include "luxel/scene/off_surface.h"
#include "luxel/viewfactor/merge_polygons.h"
#include "luxel/viewfactor/surfaces.h"

namespace luxel::hierarchical {
namespace {

/// Normals closer than this to the triangle's own are the same but for rounding.
constexpr float kFlat = 1e-5f;

bool is_curved(const scene::Scene& scene, uint32_t instance, uint32_t triangle) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  if (mesh.normals.empty()) return false;
  const Vec3 front = scene::front_normal(scene, instance, triangle);
  for (const Barycentric corner : {Barycentric{0, 0}, {1, 0}, {0, 1}})
    if (length(scene::shading_normal(scene, {instance, triangle, corner}) - front) > kFlat)
      return true;
  return false;
}

Face make_face(const scene::Scene& scene, PolygonView corners, uint32_t instance, uint32_t triangle,
               bool curved) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  Face face{{corners.begin(), corners.end()}, viewfactor::plane_of(corners)};
  Box3 box;
  for (const DVec3& corner : corners) box.extend(to_float(corner));
  face.size_m = scene::size_for_rounding(scene.instances[instance].world_from_object,
                                         box.upper - box.lower, to_float(face.plane.normal));
  face.instance = instance, face.triangle = triangle, face.curved = curved;
  face.material = mesh.triangle_material[triangle];
  const scene::Material& material = scene.materials[face.material];
  face.two_sided = material.double_sided;
  face.has_holes = material.alpha_mode == scene::AlphaMode::mask;
  return face;
}

/// Triangles of an instance that may be joined: those of one material, unless they are curved.
struct Groups {
  std::map<uint32_t, std::vector<uint32_t>> flat;  ///< per material
  std::vector<uint32_t> curved;
};
Groups groups_of(const scene::Scene& scene, uint32_t instance) {
  const scene::Mesh& mesh = scene.meshes[scene.instances[instance].mesh];
  Groups out;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (is_curved(scene, instance, t))
      out.curved.push_back(t);
    else
      out.flat[mesh.triangle_material[t]].push_back(t);
  return out;
}

Status add_instance(const scene::Scene& scene, uint32_t instance, Faces& out, Progress& progress) {
  const auto triangles = viewfactor::world_triangles(scene, instance);
  const Groups groups = groups_of(scene, instance);
  const uint32_t first = out.first_triangle[instance];
  // Each triangle of a curved surface is a face of its own.
  for (const uint32_t t : groups.curved) {
    if (viewfactor::plane_of(triangles[t]).normal == DVec3{}) continue;
    out.face_of_triangle[first + t] = uint32_t(out.faces.size());
    out.faces.push_back(make_face(scene, triangles[t], instance, t, true));
  }
  // Triangles of a flat surface are merged to as few polygons as possible, material by material.
  for (const auto& [material, members] : groups.flat) {
    std::vector<std::array<DVec3, 3>> flat;
    for (const uint32_t t : members) flat.push_back(triangles[t]);
    LUXEL_TRY(const viewfactor::MergedPolygons merged,
              viewfactor::merge_polygons(flat, out.slack_m, progress));
    const auto base = uint32_t(out.faces.size());
    // A triangle knows its polygon, and a polygon one of its triangles.
    std::vector<uint32_t> one_of(merged.polygons.size(), kNone);
    for (size_t k = 0; k < members.size(); ++k) {
      if (merged.of_triangle[k] == viewfactor::kNoPolygon) continue;
      out.face_of_triangle[first + members[k]] = base + merged.of_triangle[k];
      one_of[merged.of_triangle[k]] = members[k];
    }
    for (size_t p = 0; p < merged.polygons.size(); ++p)
      out.faces.push_back(make_face(scene, merged.polygons[p], instance, one_of[p], false));
  }
  return {};
}

}  // namespace

bool has_holes(const Faces& faces, std::span<const uint32_t> some) {
  return std::any_of(some.begin(), some.end(),
                     [&](uint32_t f) { return faces.faces[f].has_holes; });
}

Result<Faces> make_faces(const scene::Scene& scene, Progress& progress) {
  Faces out;
  out.slack_m = viewfactor::corner_rounding_m(scene);
  out.first_triangle = scene::first_triangles(scene);
  out.face_of_triangle.assign(out.first_triangle.back(), kNone);
  progress.begin("join polygons", out.first_triangle.back());
  for (uint32_t i = 0; i < scene.instances.size(); ++i)
    LUXEL_TRY_STATUS(add_instance(scene, i, out, progress));
  return out;
}

}  // namespace luxel::hierarchical
