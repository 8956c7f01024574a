#include "luxel/view/lit_scene.h"

#include <map>

#include "luxel/export/lightmap_vertices.h"

namespace luxel::view {
namespace {

/// Numbers the versions of materials by page.
class Versions {
 public:
  Versions(const scene::Scene& scene, LitScene& out) : scene_(scene), out_(out) {}

  uint32_t of(uint32_t material, uint32_t page) {
    const auto [known, fresh] =
        number_.emplace(std::pair(material, page), uint32_t(out_.scene.materials.size()));
    if (fresh) {
      out_.scene.materials.push_back(scene_.materials[material]);
      out_.page_of_material.push_back(page);
      out_.material_of_scene.push_back(material);
    }
    return known->second;
  }

 private:
  const scene::Scene& scene_;
  LitScene& out_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> number_;
};

/// The mesh of an instance, with the place of each vertex in the lightmap.
scene::Mesh lit_mesh(const scene::Mesh& mesh, const export_::LightmapCoordinates& places,
                     Versions& versions, std::vector<Vec2>& light_uv) {
  export_::VertexSplitter splitter(mesh.positions.size());
  export_::LightmapVertices vertices;
  scene::Mesh out;
  out.name = mesh.name, out.other_side = mesh.other_side;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<uint32_t, 3>& corners = out.triangles.emplace_back();
    for (size_t c = 0; c < 3; ++c)
      corners[c] = splitter.vertex(vertices, mesh.triangles[t][c], places.uv[t][c]);
    out.triangle_material.push_back(versions.of(mesh.triangle_material[t], places.page[t]));
  }
  out.positions = export_::picked(mesh.positions, vertices.source);
  out.normals = export_::picked(mesh.normals, vertices.source);
  out.uv0 = export_::picked(mesh.uv0, vertices.source),
  out.uv1 = export_::picked(mesh.uv1, vertices.source);
  out.colors = export_::picked(mesh.colors, vertices.source);
  out.alphas = export_::picked(mesh.alphas, vertices.source);
  light_uv = std::move(vertices.lightmap);
  return out;
}

}  // namespace

LitScene lit_scene(const scene::Scene& scene, const atlas::Atlas& atlas) {
  LitScene out;
  out.scene.name = scene.name;
  out.scene.textures = scene.textures;
  out.scene.lights = scene.lights, out.scene.profiles = scene.profiles;
  out.scene.cameras = scene.cameras;
  out.scene.background = scene.background, out.scene.environment = scene.environment;
  Versions versions(scene, out);
  const std::vector<atlas::Page> pages = atlas::pages_of(atlas);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const export_::LightmapCoordinates places = export_::lightmap_places(atlas, pages, i);
    scene::Instance instance = scene.instances[i];
    out.scene.meshes.push_back(
        lit_mesh(scene.meshes[instance.mesh], places, versions, out.light_uv.emplace_back()));
    instance.mesh = i;
    out.scene.instances.push_back(std::move(instance));
  }
  return out;
}

}  // namespace luxel::view
