#include "luxel/scene/merge.h"

namespace luxel::scene {
namespace {

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

bool has_surroundings(const Scene& scene) {
  return max_component(scene.background) > 0 || !scene.environment.empty();
}

/// A material whose textures are numbered from `first` on.
Material moved(Material material, uint32_t first) {
  for (TextureRef* ref : textures_of(material))
    if (ref->texture != kNone) ref->texture += first;
  return material;
}

/// Where a scene stands in another one, whose origin may be another one.
Mat34 shift_between(const Scene& from, const Scene& to) {
  return translation(to_float(from.origin - to.origin));
}

void add_meshes(const Scene& from, Scene& to) {
  const auto first_material = uint32_t(to.materials.size());
  for (Mesh mesh : from.meshes) {
    for (uint32_t& material : mesh.triangle_material) material += first_material;
    to.meshes.push_back(std::move(mesh));
  }
  for (const Material& material : from.materials)
    to.materials.push_back(moved(material, uint32_t(to.textures.size())));
  append(from.textures, to.textures);
}

}  // namespace

Scene merged(std::span<const Scene> scenes) {
  Scene out;
  if (!scenes.empty()) out.name = scenes.front().name, out.origin = scenes.front().origin;
  for (const Scene& from : scenes) {
    const Mat34 shift = shift_between(from, out);
    for (Instance instance : from.instances) {
      instance.world_from_object = shift * instance.world_from_object;
      instance.mesh += uint32_t(out.meshes.size());
      out.instances.push_back(std::move(instance));
    }
    add_meshes(from, out);
    for (PunctualLight light : from.lights) {
      if (light.profile != kNone) light.profile += uint32_t(out.profiles.size());
      light.position = transform_point(shift, light.position);
      out.lights.push_back(std::move(light));
    }
    append(from.profiles, out.profiles);
    for (Camera camera : from.cameras) {
      camera.world_from_camera = shift * camera.world_from_camera;
      out.cameras.push_back(std::move(camera));
    }
    if (has_surroundings(out) || !has_surroundings(from)) continue;
    out.background = from.background, out.environment = from.environment;
  }
  return out;
}

}  // namespace luxel::scene
