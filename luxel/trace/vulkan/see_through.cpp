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

std::array<float, 3> alphas_of(const scene::Mesh& mesh, uint32_t triangle) {
  if (mesh.alphas.empty()) return {1, 1, 1};
  const auto [a, b, c] = mesh.triangles[triangle];
  return {mesh.alphas[a], mesh.alphas[b], mesh.alphas[c]};
}

}  // namespace

SeeThroughFinder::SeeThroughFinder(const scene::Scene& scene, SeeThrough& out)
    : scene_(scene),
      out_(out),
      pictures_(scene, out.texels),
      any_(std::ranges::any_of(scene.materials, scene::lets_light_through)),
      first_triangle_(scene::first_triangles(scene)),
      material_there_(scene.materials.size(), scene::kNone) {}

void SeeThroughFinder::find(std::span<DeviceTriangle> triangles) {
  if (!any_) return;
  for (DeviceTriangle& t : triangles) {
    const auto drawn = scene::drawn_triangle(first_triangle_, t.number);
    const scene::Mesh& mesh = scene_.meshes[scene_.instances[drawn.instance].mesh];
    const uint32_t number = mesh.triangle_material[drawn.triangle];
    const scene::Material& m = scene_.materials[number];
    if (!scene::lets_light_through(m)) continue;
    uint32_t& there = material_there_[number];
    if (there == scene::kNone) {
      there = uint32_t(out_.materials.size());
      out_.materials.push_back({uint32_t(m.alpha_mode), m.alpha, m.alpha_cutoff, m.transmission,
                                m.metallic, pictures_.picture(m.base_color_texture),
                                pictures_.picture(m.metallic_texture),
                                pictures_.picture(m.transmission_texture)});
    }
    out_.triangles.push_back({drawn.instance, drawn.triangle, there, placed(mesh, m),
                              places_in_picture(mesh, drawn.triangle, m.base_color_texture),
                              places_in_picture(mesh, drawn.triangle, m.metallic_texture),
                              places_in_picture(mesh, drawn.triangle, m.transmission_texture),
                              alphas_of(mesh, drawn.triangle)});
    t.see_through = uint32_t(out_.triangles.size());
  }
}

}  // namespace luxel::trace
