#include "luxel/view/edit/drawn_edits.h"

#include <algorithm>

namespace luxel::view {

std::vector<uint32_t> materials_as_read(const scene::Scene& as_read, const scene::Scene& drawn,
                                        std::span<const uint32_t> of_layout) {
  std::vector<uint32_t> out;
  for (uint32_t m = 0; m < drawn.materials.size(); ++m)
    out.push_back(of_layout.empty() ? m : of_layout[m]);
  // A layout adds one-sided copies of materials behind those that were read. A triangle of one was
  // read with what it is a copy of; its other side comes after all that were read.
  const auto known = uint32_t(as_read.materials.size());
  std::vector<uint32_t> source(known);
  for (uint32_t m = 0; m < known; ++m) source[m] = m;
  for (uint32_t m : out) source.resize(std::max(source.size(), size_t(m) + 1), 0);
  for (size_t i = 0; i < as_read.instances.size(); ++i) {
    const scene::Mesh& read = as_read.meshes[as_read.instances[i].mesh];
    const scene::Mesh& mesh = drawn.meshes[drawn.instances[i].mesh];
    for (size_t t = 0; t < read.triangles.size(); ++t)
      source[out[mesh.triangle_material[t]]] = read.triangle_material[t];
  }
  for (uint32_t& m : out) m = source[m];
  return out;
}

void put_edits(const SceneNow& now, std::span<const uint32_t> of_material, DeviceScene& scene) {
  for (uint32_t i = 0; i < now.world_from_object.size(); ++i)
    set_transform(i, now.world_from_object[i], scene);
  for (size_t m = 0; m < of_material.size(); ++m) {
    const MaterialLook& look = now.materials[of_material[m]];
    set_base_color(m, look.base_color, scene), set_emission(m, look.emission, scene);
    set_metallic(m, look.metallic, scene);
  }
}

std::optional<Outline> outline_of(const EditSelection& selected,
                                  std::span<const uint32_t> of_material) {
  if (!selected.instance && !selected.material) return std::nullopt;
  Outline out;
  out.instance = selected.instance;
  for (uint32_t m = 0; selected.material && m < of_material.size(); ++m)
    if (of_material[m] == *selected.material) out.materials.push_back(m);
  return out;
}

}  // namespace luxel::view
