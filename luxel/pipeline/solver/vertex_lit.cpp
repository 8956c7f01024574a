#include "luxel/pipeline/solver/vertex_lit.h"

#include <utility>

#include "luxel/image/white_level.h"

namespace luxel::pipeline {
namespace {

/// Builds the mesh of one instance; the same vertex of the field becomes one vertex of the mesh.
struct MeshBuilder {
  const scene::Scene& scene;
  const hemicube::Field& field;
  float intensity = 1;
  std::vector<uint32_t> number;  ///< per vertex of the field: in `mesh`
  scene::Mesh mesh;

  Rgb light(uint32_t element) const { return field.irradiance[element] / intensity; }

  uint32_t add_vertex(const hemicube::Node& node, size_t k, Rgb color) {
    const scene::Mesh& own = scene.meshes[scene.instances[node.instance].mesh];
    const scene::SurfacePoint p{node.instance, node.triangle, node.at[k]};
    const auto& t = own.triangles[node.triangle];
    // The place of the mesh, not of the triangle: equal for all triangles that meet there.
    mesh.positions.push_back(field.mesh.points[node.point[k]]);
    mesh.normals.push_back(scene::shading_normal(scene, p));
    if (!own.uv0.empty())
      mesh.uv0.push_back(interpolate(own.uv0[t[0]], own.uv0[t[1]], own.uv0[t[2]], p.at));
    if (!own.uv1.empty())
      mesh.uv1.push_back(interpolate(own.uv1[t[0]], own.uv1[t[1]], own.uv1[t[2]], p.at));
    if (!own.colors.empty())
      color = color * interpolate(own.colors[t[0]], own.colors[t[1]], own.colors[t[2]], p.at);
    mesh.colors.push_back(color);
    if (!own.alphas.empty())
      mesh.alphas.push_back(
          interpolate(own.alphas[t[0]], own.alphas[t[1]], own.alphas[t[2]], p.at));
    return uint32_t(mesh.positions.size() - 1);
  }

  void add_leaf(uint32_t leaf) {
    const hemicube::Node& node = field.mesh.nodes[field.receivers.leaves[leaf]];
    const scene::Instance& instance = scene.instances[node.instance];
    const scene::Mesh& own = scene.meshes[instance.mesh];
    const bool shared = field.receivers.kind == hemicube::ElementKind::vertex && own.uv0.empty() &&
                        own.uv1.empty() && own.colors.empty() && own.alphas.empty();
    std::array<uint32_t, 3> corners{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = node.vertex[k];
      if (shared && number[v] != scene::kNone) {
        corners[k] = number[v];
        continue;
      }
      const uint32_t element = field.receivers.kind == hemicube::ElementKind::vertex ? v : leaf;
      corners[k] = number[v] = add_vertex(node, k, light(element));
    }
    // In the world a mirrored instance's triangles run the other way round.
    if (determinant(instance.world_from_object) < 0) std::swap(corners[1], corners[2]);
    mesh.triangles.push_back(corners);
    mesh.triangle_material.push_back(own.triangle_material[node.triangle]);
  }
};

}  // namespace

VertexLit vertex_lit(const scene::Scene& scene, const hemicube::Field& field) {
  VertexLit out;
  out.intensity = image::white_level(field.irradiance);
  out.scene = scene;
  out.scene.meshes.clear(), out.scene.instances.clear(), out.scene.lights.clear();
  for (scene::Material& material : out.scene.materials) {
    material.unlit = true;
    // KHR_materials_unlit goes with no other extension, and unlit surfaces show neither.
    material.emission = {}, material.transmission = 0, material.diffuse_transmission = 0;
  }
  std::vector<std::vector<uint32_t>> leaves(scene.instances.size());
  for (uint32_t i = 0; i < field.receivers.leaves.size(); ++i)
    leaves[field.mesh.nodes[field.receivers.leaves[i]].instance].push_back(i);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    MeshBuilder builder{scene, field, out.intensity, {}, {}};
    builder.number.assign(field.mesh.vertices.size(), scene::kNone);
    for (const uint32_t leaf : leaves[i]) builder.add_leaf(leaf);
    builder.mesh.name = scene.meshes[scene.instances[i].mesh].name;
    out.scene.instances.push_back({scene.instances[i].name, uint32_t(out.scene.meshes.size()), {}});
    out.scene.meshes.push_back(std::move(builder.mesh));
  }
  return out;
}

}  // namespace luxel::pipeline
