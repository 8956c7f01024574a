// Changes of a scene that lies on a device.
#include "luxel/base/check.h"
#include "luxel/view/draw/device_structs.h"

namespace luxel::view {
namespace {

on_device::Material& material_on(DeviceScene& scene, size_t material) {
  LUXEL_CHECK((material + 1) * sizeof(on_device::Material) <= scene.materials.size);
  return reinterpret_cast<on_device::Material*>(scene.materials.mapped)[material];
}

on_device::Instance& instance_on(DeviceScene& scene, uint32_t instance) {
  LUXEL_CHECK(instance < scene.mesh_of.size());
  return reinterpret_cast<on_device::Instance*>(scene.instances.mapped)[instance];
}

}  // namespace

void set_emission(size_t material, Rgb emission, DeviceScene& scene) {
  material_on(scene, material).emission = emission;
  if (max_component(emission) > 0) scene.glows_or_is_metal[material] = 1;
}

void set_base_color(size_t material, Rgb base_color, DeviceScene& scene) {
  material_on(scene, material).base_color = base_color;
}

void set_metallic(size_t material, float metallic, DeviceScene& scene) {
  material_on(scene, material).metallic = metallic;
  if (metallic > 0) scene.glows_or_is_metal[material] = 1;
}

void set_transform(uint32_t instance, const Mat34& world_from_object, DeviceScene& scene) {
  on_device::Instance& to = instance_on(scene, instance);
  const auto& row = world_from_object.row;
  to.row0 = row[0], to.row1 = row[1], to.row2 = row[2];
  scene.is_mirrored[instance] = determinant(world_from_object) < 0;
}

Status put_light(gpu::Commands& commands, std::span<const image::HalfImage> pages, uint32_t which,
                 DeviceScene& scene) {
  LUXEL_CHECK(pages.size() == scene.lights[which].size());
  LUXEL_CHECK(scene.lights[0] != scene.lights[1]);
  for (size_t page = 0; page < pages.size(); ++page) {
    LUXEL_TRY_STATUS(gpu::put_pixels(commands, *scene.lights[which][page],
                                     bytes_of(pages[page].data), "the lightmap"));
    scales_of(scene)[2 * page + which] = pages[page].scale;
  }
  return {};
}

Status set_surroundings(gpu::Commands& commands, const scene::Environment& map,
                        DeviceScene& scene) {
  const gpu::PictureParams& params = scene.surroundings.picture->params;
  LUXEL_CHECK(uint32_t(map.width) == params.width && uint32_t(map.height) == params.height);
  const image::HalfImage half = half_of(map);
  scene.surroundings_scale = half.scale, scene.rotation_rad = map.rotation_rad;
  return gpu::put_pixels(commands, *scene.surroundings.picture, bytes_of(half.data),
                         "the surroundings");
}

void set_emission_factor(uint32_t instance, Rgb factor, DeviceScene& scene) {
  instance_on(scene, instance).emission_factor = factor;
}

}  // namespace luxel::view
