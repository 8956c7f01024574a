#include "luxel/trace/vulkan/see_through.h"

#include <algorithm>

#include "luxel/scene/drawn_triangle.h"
#include "luxel/trace/vulkan/device_pictures.h"

namespace luxel::trace {
namespace {

uint32_t placed(const scene::Mesh& mesh, const scene::Material& m) {
  return uint32_t(!texture_coordinates(mesh, m.base_color_texture).empty()) |
         uint32_t(!texture_coordinates(mesh, m.metallic_texture).empty()) << 1 |
         uint32_t(!texture_coordinates(mesh, m.transmission_texture).empty()) << 2;
}

}  // namespace

SeeThrough find_see_through(const scene::Scene& scene, std::vector<DeviceTriangle>& triangles) {
  SeeThrough out;
  if (std::ranges::none_of(scene.materials, scene::lets_light_through)) return out;
  DevicePictures pictures(scene, out.texels);
  std::vector<uint32_t> material_there(scene.materials.size(), scene::kNone);
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  for (DeviceTriangle& t : triangles) {
    const auto drawn = scene::drawn_triangle(first, t.number);
    const scene::Mesh& mesh = scene.meshes[scene.instances[drawn.instance].mesh];
    const uint32_t number = mesh.triangle_material[drawn.triangle];
    const scene::Material& m = scene.materials[number];
    if (!scene::lets_light_through(m)) continue;
    uint32_t& there = material_there[number];
    if (there == scene::kNone) {
      there = uint32_t(out.materials.size());
      out.materials.push_back({uint32_t(m.alpha_mode), m.alpha, m.alpha_cutoff, m.transmission,
                               m.metallic, pictures.picture(m.base_color_texture),
                               pictures.picture(m.metallic_texture),
                               pictures.picture(m.transmission_texture)});
    }
    out.triangles.push_back({drawn.instance, drawn.triangle, there, placed(mesh, m),
                             places_in_picture(mesh, drawn.triangle, m.base_color_texture),
                             places_in_picture(mesh, drawn.triangle, m.metallic_texture),
                             places_in_picture(mesh, drawn.triangle, m.transmission_texture)});
    t.see_through = uint32_t(out.triangles.size());
  }
  return out;
}

}  // namespace luxel::trace
