#include "luxel/solve/matrix/relight_data.h"

namespace luxel::matrix {

std::vector<Rgb> mean_emission_of(const RelightData& data) {
  return mean_emission_of(data.emission, data.material, data.area_m2, data.material_name.size());
}

scene::Scene scene_of(const Occluders& occluders) {
  scene::Scene scene;
  scene.materials.emplace_back();
  scene::Mesh mesh;
  mesh.positions = occluders.position, mesh.triangles = occluders.triangle;
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"occluders", 0, {}});
  return scene;
}

}  // namespace luxel::matrix
