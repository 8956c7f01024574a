#include "luxel/trace/vulkan/see_through.h"

#include <algorithm>
#include <cstring>

#include "luxel/scene/drawn_triangle.h"

namespace luxel::trace {
namespace {

/// Puts each texture into the texels once.
class Pictures {
 public:
  Pictures(const scene::Scene& scene, std::vector<uint32_t>& texels)
      : scene_(scene), texels_(texels), first_(scene.textures.size(), scene::kNone) {}

  DevicePicture picture(const scene::TextureRef& ref) {
    if (ref.texture == scene::kNone) return {};
    const scene::Texture& t = scene_.textures[ref.texture];
    uint32_t& first = first_[ref.texture];
    if (first == scene::kNone) {
      first = uint32_t(texels_.size());
      texels_.resize(texels_.size() + t.rgba.size() / 4);
      std::memcpy(texels_.data() + first, t.rgba.data(), t.rgba.size() / 4 * 4);
    }
    return {first,
            uint32_t(t.width),
            uint32_t(t.height),
            uint32_t(ref.wrap_u),
            uint32_t(ref.wrap_v),
            uint32_t(ref.filter == scene::Filter::nearest)};
  }

 private:
  const scene::Scene& scene_;
  std::vector<uint32_t>& texels_;
  std::vector<uint32_t> first_;  ///< per texture
};

const std::vector<Vec2>& coordinates(const scene::Mesh& mesh, const scene::TextureRef& ref) {
  return ref.uv_set == 1 ? mesh.uv1 : mesh.uv0;
}

std::array<Vec2, 3> places(const scene::Mesh& mesh, uint32_t triangle,
                           const scene::TextureRef& ref) {
  const std::vector<Vec2>& uv = coordinates(mesh, ref);
  std::array<Vec2, 3> out{};
  if (uv.empty()) return out;
  for (size_t k = 0; k < 3; ++k)
    out[k] = scene::transformed_uv(ref, uv[mesh.triangles[triangle][k]]);
  return out;
}

uint32_t placed(const scene::Mesh& mesh, const scene::Material& m) {
  return uint32_t(!coordinates(mesh, m.base_color_texture).empty()) |
         uint32_t(!coordinates(mesh, m.metallic_texture).empty()) << 1 |
         uint32_t(!coordinates(mesh, m.transmission_texture).empty()) << 2;
}

}  // namespace

SeeThrough find_see_through(const scene::Scene& scene, std::vector<DeviceTriangle>& triangles) {
  SeeThrough out;
  if (std::ranges::none_of(scene.materials, scene::lets_light_through)) return out;
  Pictures pictures(scene, out.texels);
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
                             places(mesh, drawn.triangle, m.base_color_texture),
                             places(mesh, drawn.triangle, m.metallic_texture),
                             places(mesh, drawn.triangle, m.transmission_texture)});
    t.see_through = uint32_t(out.triangles.size());
  }
  return out;
}

}  // namespace luxel::trace
