#include "luxel/view/draw/device_scene.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <span>
#include <tuple>

#include "luxel/base/check.h"
#include "luxel/view/draw/device_structs.h"

namespace luxel::view {
namespace {

/// scene::transformed_uv() as two rows that are multiplied by (u, v, 1).
on_device::LookUp look_up_of(const scene::TextureRef& ref) {
  const Vec2 o = scene::transformed_uv(ref, {0, 0});
  const Vec2 u = scene::transformed_uv(ref, {1, 0}), v = scene::transformed_uv(ref, {0, 1});
  return {{u.x - o.x, v.x - o.x, o.x}, {u.y - o.y, v.y - o.y, o.y}, uint32_t(ref.uv_set)};
}

/// Puts pictures and samplers on the device, each once.
class Pictures {
 public:
  Pictures(gpu::Commands& commands, const scene::Scene& scene, DeviceScene& out)
      : commands_(commands), scene_(scene), out_(out) {}

  /// One white pixel: what is looked up where there is no picture.
  Result<gpu::Binding> white() {
    constexpr std::array<uint8_t, 4> kWhite{255, 255, 255, 255};
    if (white_ == nullptr) {
      gpu::PictureParams params;
      params.width = params.height = 1;
      LUXEL_TRY(white_, add(params, bytes_of(kWhite), "a white pixel"));
    }
    return binding(white_, {});
  }

  /// A texture of the scene: display values, or numbers where `is_linear`.
  Result<gpu::Binding> texture(const scene::TextureRef& ref, bool is_linear) {
    if (ref.texture == scene::kNone) return white();
    const scene::Texture& texture = scene_.textures[ref.texture];
    const gpu::Picture*& picture = textures_[{ref.texture, is_linear}];
    if (picture == nullptr) {
      gpu::PictureParams params;
      params.format = is_linear ? VK_FORMAT_R8G8B8A8_UNORM : VK_FORMAT_R8G8B8A8_SRGB;
      params.width = uint32_t(texture.width), params.height = uint32_t(texture.height);
      params.levels = gpu::full_levels(params.width, params.height);
      LUXEL_TRY(picture, add(params, bytes_of(texture.rgba), "the texture " + texture.name));
    }
    const auto wrap = [](scene::Wrap w) {
      if (w == scene::Wrap::clamp) return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
      return w == scene::Wrap::mirror ? VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT
                                      : VK_SAMPLER_ADDRESS_MODE_REPEAT;
    };
    const bool is_nearest = ref.filter == scene::Filter::nearest;
    return binding(picture, {is_nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR, wrap(ref.wrap_u),
                             wrap(ref.wrap_v)});
  }

  /// Linear light. `around`: how the width goes on at its end.
  Result<gpu::Binding> light(const image::HalfImage& half, VkSamplerAddressMode around,
                             std::string_view what) {
    gpu::PictureParams params;
    params.format = VK_FORMAT_R16G16B16A16_SFLOAT;
    params.width = uint32_t(half.width), params.height = uint32_t(half.height);
    LUXEL_TRY(const gpu::Picture* picture, add(params, bytes_of(half.data), what));
    return binding(picture, {VK_FILTER_LINEAR, around, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
  }

 private:
  Result<const gpu::Picture*> add(const gpu::PictureParams& params,
                                  std::span<const std::byte> pixels, std::string_view what) {
    LUXEL_TRY(gpu::Picture picture, gpu::picture_with(commands_, params, pixels, what));
    out_.pictures.push_back(std::move(picture));
    return &out_.pictures.back();
  }

  Result<gpu::Binding> binding(const gpu::Picture* picture, const gpu::SamplerParams& params) {
    VkSampler& sampler = samplers_[{params.filter, params.u, params.v}];
    if (sampler == VK_NULL_HANDLE) {
      LUXEL_TRY(gpu::OwnedSampler made, gpu::make_sampler(commands_.device(), params));
      sampler = made.get();
      out_.samplers.push_back(std::move(made));
    }
    return gpu::Binding{picture, sampler};
  }

  gpu::Commands& commands_;
  const scene::Scene& scene_;
  DeviceScene& out_;
  const gpu::Picture* white_ = nullptr;
  std::map<std::pair<uint32_t, bool>, const gpu::Picture*> textures_;
  std::map<std::tuple<VkFilter, VkSamplerAddressMode, VkSamplerAddressMode>, VkSampler> samplers_;
};

/// A mesh and the places of its vertices in the lightmap; none where there are none.
struct LitMesh {
  const scene::Mesh& mesh;
  std::span<const Vec2> light_uv;
};

on_device::Vertex vertex_of(const LitMesh& lit, uint32_t i) {
  const scene::Mesh& mesh = lit.mesh;
  const Vec2 light = lit.light_uv.empty() ? Vec2{} : lit.light_uv[i];
  return {mesh.positions[i],
          mesh.uv0.empty() ? Vec2{} : mesh.uv0[i],
          mesh.uv1.empty() ? Vec2{} : mesh.uv1[i],
          light,
          light,
          mesh.normals.empty() ? Vec3{} : mesh.normals[i],
          mesh.colors.empty() ? Rgb{1, 1, 1} : mesh.colors[i],
          mesh.alphas.empty() ? 0 : 1 - mesh.alphas[i]};
}

/// Triangles of all meshes in the making.
struct Triangles {
  std::vector<on_device::Vertex> vertices;
  std::vector<uint32_t> indices;
};

/// The corners of a triangle that has another side, (a, c, b) of it: each becomes a vertex of its
/// own, which knows where light lies on that side.
void add_two_sided(const LitMesh& lit, uint32_t triangle, Triangles& out) {
  const auto& front = lit.mesh.triangles[triangle];
  const auto& back = lit.mesh.triangles[lit.mesh.other_side[triangle]];
  for (const size_t corner : {0, 1, 2}) {
    on_device::Vertex vertex = vertex_of(lit, front[corner]);
    vertex.light_behind = lit.light_uv[back[(3 - corner) % 3]];
    out.indices.push_back(uint32_t(out.vertices.size()));
    out.vertices.push_back(vertex);
  }
}

/// A mesh's triangles by their materials.
std::vector<DrawRange> add_mesh(const scene::Scene& scene, const LitMesh& lit, Triangles& out) {
  const scene::Mesh& mesh = lit.mesh;
  const auto first_vertex = uint32_t(out.vertices.size());
  for (uint32_t i = 0; i < mesh.positions.size(); ++i) out.vertices.push_back(vertex_of(lit, i));
  std::vector<DrawRange> ranges;
  for (const uint32_t t : triangles_by_material(mesh)) {
    const uint32_t material = mesh.triangle_material[t];
    if (ranges.empty() || ranges.back().material != material)
      ranges.push_back({uint32_t(out.indices.size()), 0, material});
    ranges.back().indices += 3;
    const bool has_other_side = !mesh.other_side.empty() && !lit.light_uv.empty() &&
                                mesh.other_side[t] != scene::kNone &&
                                scene.materials[material].diffuse_transmission > 0;
    if (has_other_side)
      add_two_sided(lit, t, out);
    else
      for (const uint32_t corner : mesh.triangles[t]) out.indices.push_back(first_vertex + corner);
  }
  return ranges;
}

Status put_meshes(const gpu::Device& device, const scene::Scene& scene,
                  std::span<const std::vector<Vec2>> light_uv, DeviceScene& out) {
  Triangles triangles;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    const LitMesh lit{mesh, light_uv.empty() ? mesh.uv1 : light_uv[m]};
    out.ranges.push_back(add_mesh(scene, lit, triangles));
  }
  std::vector<on_device::Instance> instances;
  for (const scene::Instance& instance : scene.instances) {
    const Mat34& m = instance.world_from_object;
    instances.push_back({m.row[0], m.row[1], m.row[2], {1, 1, 1}});
    out.mesh_of.push_back(instance.mesh);
    out.is_mirrored.push_back(determinant(m) < 0);
  }
  LUXEL_TRY(out.vertices,
            gpu::buffer_with(device, bytes_of(triangles.vertices), "the scene's vertices"));
  LUXEL_TRY(out.indices,
            gpu::buffer_with(device, bytes_of(triangles.indices), "the scene's triangles"));
  LUXEL_TRY(out.instances, gpu::buffer_with(device, bytes_of(instances), "the scene's instances"));
  return {};
}

on_device::Material device_material(const scene::Material& m, size_t page) {
  on_device::Material out{};
  out.base_color = m.base_color, out.alpha = m.alpha;
  out.emission = m.emission, out.metallic = m.metallic;
  out.cutoff = m.alpha_mode == scene::AlphaMode::mask ? m.alpha_cutoff : 0;
  out.page = uint32_t(page);
  out.unlit = m.unlit;
  out.through_color = m.diffuse_transmission_color, out.through = m.diffuse_transmission;
  out.map = look_up_of(m.base_color_texture);
  out.metal = look_up_of(m.metallic_texture);
  out.glow = look_up_of(m.emission_texture);
  out.through_share = look_up_of(m.diffuse_transmission_texture);
  out.through_tint = look_up_of(m.diffuse_transmission_color_texture);
  return out;
}

/// The bindings of each page's light, of either picture.
using Lights = std::vector<std::array<gpu::Binding, 2>>;
Result<Lights> put_lights(const gpu::Device& device, Pictures& pictures,
                          std::span<const image::HalfImage> pages, bool changes, DeviceScene& out) {
  Lights lights;
  const size_t size = sizeof(on_device::LightNow) + pages.size() * 2 * sizeof(float);
  LUXEL_TRY(out.light_now,
            gpu::make_buffer(device, size, gpu::Access::from_host, "the scales of light"));
  light_now(out) = {}, light_now(out).lamp_share = 1;
  for (const image::HalfImage& half : pages) {
    std::array<gpu::Binding, 2>& light = lights.emplace_back();
    for (const size_t which : {0, 1}) {
      if (which == 0 || changes) {
        LUXEL_TRY(light[which],
                  pictures.light(half, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, "the lightmap"));
      } else {
        light[1] = light[0];
      }
      out.lights[which].push_back(light[which].picture);
      scales_of(out)[2 * (lights.size() - 1) + which] = half.scale;
    }
  }
  return lights;
}

/// Each material with its pictures and the lightmap of its page.
Status put_materials(const gpu::Device& device, Pictures& pictures, const scene::Scene& scene,
                     std::span<const size_t> page_of_material, const Lights& lights,
                     DeviceScene& out) {
  std::vector<on_device::Material> materials;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const scene::Material& m = scene.materials[i];
    const size_t page = page_of_material[i];
    materials.push_back(device_material(m, page));
    LUXEL_TRY(const gpu::Binding map, pictures.texture(m.base_color_texture, false));
    LUXEL_TRY(const gpu::Binding metal, pictures.texture(m.metallic_texture, true));
    LUXEL_TRY(const gpu::Binding glow, pictures.texture(m.emission_texture, false));
    LUXEL_TRY(const gpu::Binding share, pictures.texture(m.diffuse_transmission_texture, true));
    LUXEL_TRY(const gpu::Binding tint,
              pictures.texture(m.diffuse_transmission_color_texture, false));
    out.bindings.push_back({lights[page][0], map, metal, glow, share, tint, lights[page][1],
                            out.shadow_maps, out.shadow_depth});
    out.is_double_sided.push_back(m.double_sided);
    out.is_masked.push_back(m.alpha_mode == scene::AlphaMode::mask && m.alpha_cutoff > 0);
    out.scatters_through.push_back(m.diffuse_transmission > 0);
    out.glows_or_is_metal.push_back(m.metallic > 0 || max_component(m.emission) > 0);
  }
  LUXEL_TRY(out.materials, gpu::buffer_with(device, bytes_of(materials), "the scene's materials"));
  return {};
}

Status put_surroundings(Pictures& pictures, const scene::Scene& scene, DeviceScene& out) {
  out.background = scene.background;
  LUXEL_TRY(out.surroundings, pictures.white());
  const scene::Environment& map = scene.environment;
  if (map.empty()) return {};
  const image::HalfImage half = half_of(map);
  out.surroundings_scale = half.scale;
  LUXEL_TRY(out.surroundings,
            pictures.light(half, VK_SAMPLER_ADDRESS_MODE_REPEAT, "the surroundings"));
  out.rotation_rad = map.rotation_rad;
  return {};
}

/// Makes the shadow maps of lamps, of undefined content.
Status put_shadow_maps(gpu::Commands& commands, uint32_t side, DeviceScene& out) {
  const gpu::Device& device = commands.device();
  gpu::PictureParams params;
  params.format = VK_FORMAT_D32_SFLOAT;
  params.width = params.height = side;
  params.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  LUXEL_TRY(gpu::Picture picture, gpu::make_picture(device, params, "the maps of shadows"));
  LUXEL_TRY_STATUS(commands.run([&](VkCommandBuffer buffer) {
    gpu::change_layout(device, buffer, picture, VK_IMAGE_LAYOUT_UNDEFINED,
                       VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  }));
  constexpr VkSamplerAddressMode kClamp = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  LUXEL_TRY(gpu::OwnedSampler sampler,
            gpu::make_sampler(device, {VK_FILTER_NEAREST, kClamp, kClamp, true}));
  LUXEL_TRY(gpu::OwnedSampler depth,
            gpu::make_sampler(device, {VK_FILTER_NEAREST, kClamp, kClamp, false,
                                       VK_SAMPLER_MIPMAP_MODE_NEAREST}));
  out.pictures.push_back(std::move(picture));
  out.shadow_maps = {&out.pictures.back(), sampler.get()};
  out.shadow_depth = {&out.pictures.back(), depth.get()};
  out.samplers.push_back(std::move(sampler));
  out.samplers.push_back(std::move(depth));
  return {};
}

}  // namespace

std::vector<uint32_t> triangles_by_material(const scene::Mesh& mesh) {
  std::vector<uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return mesh.triangle_material[a] < mesh.triangle_material[b];
  });
  return order;
}

on_device::LightNow& light_now(const DeviceScene& scene) {
  return *reinterpret_cast<on_device::LightNow*>(scene.light_now.mapped);
}

Result<DeviceScene> put_on_device(gpu::Commands& commands, const scene::Scene& scene,
                                  const PagesOfLight& light, const DeviceSceneParams& params) {
  DeviceScene out;
  out.bounds = scene::world_bounds(scene);
  Pictures pictures(commands, scene, out);
  LUXEL_TRY_STATUS(put_meshes(commands.device(), scene, params.light_uv, out));
  LUXEL_TRY_STATUS(put_shadow_maps(commands, params.shadow_side, out));
  LUXEL_TRY(const Lights lights,
            put_lights(commands.device(), pictures, light.pages, params.light_changes, out));
  LUXEL_TRY_STATUS(
      put_materials(commands.device(), pictures, scene, light.of_material, lights, out));
  LUXEL_TRY_STATUS(put_surroundings(pictures, scene, out));
  return out;
}

Result<DeviceScene> put_on_device(gpu::Commands& commands, const scene::Scene& scene,
                                  const pipeline::LightmapPages& lightmaps,
                                  const DeviceSceneParams& params) {
  std::vector<image::HalfImage> halves;
  for (const image::Image& page : lightmaps.pictures) halves.push_back(image::to_half(page));
  return put_on_device(commands, scene, PagesOfLight{halves, lightmaps.of_material}, params);
}

}  // namespace luxel::view
