#include "luxel/reference/device/path_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/reference/device/paths_shared.h"
#include "luxel/scene/facet.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/trace/vulkan/device_pictures.h"

namespace luxel::reference {
namespace {

using on_device::PathLight, on_device::PathMaterial, on_device::PathSetup, on_device::PathTriangle;

template <class T>
Result<gpu::Buffer> uploaded(gpu::Commands& commands, std::span<const T> values) {
  return gpu::uploaded_or_one(commands, values, "the buffer of what paths look at");
}

/// True: vertex normals bend the surface over the triangle, as in transport::smooth_point().
bool bends(const std::array<Vec3, 3>& normals, Vec3 front) {
  return std::ranges::all_of(normals, [&](Vec3 n) { return dot(normalize(n), front) >= 0.5f; });
}

PathTriangle path_triangle(const TracedScene& world, uint32_t instance, uint32_t triangle) {
  const scene::Instance& placed = world.scene.instances[instance];
  const scene::Mesh& mesh = world.scene.meshes[placed.mesh];
  const scene::Material& m = world.scene.materials[mesh.triangle_material[triangle]];
  const scene::Triangle3 corners = scene::world_triangle(world.scene, instance, triangle);
  const uint32_t number = world.surfaces.number(instance, triangle);
  PathTriangle t{};
  t.corner = {corners.a, corners.b, corners.c};
  t.front = world.surfaces.front[number];
  t.size_m = std::sqrt(scene::area_m2(corners));
  t.size_for_rounding_m = world.surfaces.size_m[number];
  for (size_t k = 0; k < 3; ++k) {
    const uint32_t vertex = mesh.triangles[triangle][k];
    t.color[k] = mesh.colors.empty() ? Rgb{1, 1, 1} : mesh.colors[vertex];
    t.alpha[k] = mesh.alphas.empty() ? 1 : mesh.alphas[vertex];
    if (!mesh.normals.empty())
      t.normal[k] = transform_normal(placed.world_from_object, mesh.normals[vertex]);
  }
  if (world.surfaces.curved[number]) t.flags |= on_device::kCurved;
  if (!mesh.normals.empty() && bends(t.normal, t.front)) t.flags |= on_device::kBends;
  const auto place = [&](const scene::TextureRef& ref, std::array<Vec2, 3>& to, uint32_t flag) {
    to = trace::places_in_picture(mesh, triangle, ref);
    if (!trace::texture_coordinates(mesh, ref).empty()) t.flags |= flag;
  };
  place(m.base_color_texture, t.base, on_device::kBasePlaced);
  place(m.metallic_texture, t.metal, on_device::kMetalPlaced);
  place(m.emission_texture, t.emission, on_device::kEmissionPlaced);
  t.material = mesh.triangle_material[triangle];
  const bool is_sheet = !mesh.other_side.empty() && mesh.other_side[triangle] != scene::kNone;
  t.other_side = is_sheet ? world.surfaces.number(instance, mesh.other_side[triangle])
                          : on_device::kNoTriangle;
  t.pdf_area = world.emitters.pdf_area[number];
  return t;
}

std::vector<PathTriangle> path_triangles(const TracedScene& world) {
  std::vector<PathTriangle> out;
  out.reserve(world.surfaces.front.size());
  for (uint32_t i = 0; i < world.scene.instances.size(); ++i) {
    const size_t count = world.scene.meshes[world.scene.instances[i].mesh].triangles.size();
    for (uint32_t t = 0; t < count; ++t) out.push_back(path_triangle(world, i, t));
  }
  return out;
}

PathMaterial path_material(const scene::Material& m, trace::DevicePictures& pictures) {
  const uint32_t flags = (m.double_sided ? on_device::kDoubleSided : 0) |
                         (m.unlit ? on_device::kUnlit : 0) |
                         (m.alpha_mode == scene::AlphaMode::mask ? on_device::kMasked : 0) |
                         (scene::reflects_from_behind(m) ? on_device::kReflectsFromBehind : 0);
  return {m.base_color,
          m.emission,
          m.alpha,
          m.alpha_cutoff,
          m.metallic,
          flags,
          pictures.picture(m.base_color_texture),
          pictures.picture(m.metallic_texture),
          pictures.picture(m.emission_texture)};
}

PathLight path_light(const scene::PunctualLight& light) {
  const bool disc = scene::has_disc(light);
  const float half_sine = std::sin(0.5f * light.angular_radius_rad);
  const float outer = std::cos(light.outer_cone_rad);
  return {light.intensity,
          light.position,
          light.direction,
          light.range_m,
          outer,
          std::max(0.001f, std::cos(light.inner_cone_rad) - outer),
          2 * half_sine * half_sine,
          disc ? std::sin(light.angular_radius_rad) : 0.0f,
          uint32_t(light.kind),
          uint32_t(disc)};
}

Status upload_surfaces(gpu::Commands& commands, const TracedScene& world,
                       PathBuffersOnDevice& out) {
  std::vector<uint32_t> texels;
  trace::DevicePictures pictures(world.scene, texels);
  std::vector<PathMaterial> materials;
  for (const scene::Material& m : world.scene.materials)
    materials.push_back(path_material(m, pictures));
  const std::array<float, 256> linear = trace::linear_of_bytes();
  LUXEL_TRY(out.triangles, uploaded<PathTriangle>(commands, path_triangles(world)));
  LUXEL_TRY(out.materials, uploaded<PathMaterial>(commands, materials));
  LUXEL_TRY(out.texels, uploaded<uint32_t>(commands, texels));
  LUXEL_TRY(out.linear_of_byte, uploaded<float>(commands, linear));
  return {};
}

Status upload_lights(gpu::Commands& commands, const TracedScene& world, PathBuffersOnDevice& out) {
  std::vector<uint32_t> emitters;
  for (const Emitter& e : world.emitters.triangles)
    emitters.push_back(world.surfaces.number(e.instance, e.triangle));
  std::vector<PathLight> lights;
  for (const scene::PunctualLight& light : world.scene.lights) lights.push_back(path_light(light));
  LUXEL_TRY(out.emitters, uploaded<uint32_t>(commands, emitters));
  LUXEL_TRY(out.chance_below, uploaded<double>(commands, world.emitters.chance_below));
  LUXEL_TRY(out.lights, uploaded<PathLight>(commands, lights));
  LUXEL_TRY(out.row_below, uploaded<double>(commands, world.sky.row_below));
  LUXEL_TRY(out.column_below, uploaded<double>(commands, world.sky.column_below));
  LUXEL_TRY(out.pixels, uploaded<Rgb>(commands, world.scene.environment.radiance));
  return {};
}

}  // namespace

Result<PathBuffersOnDevice> upload_world(gpu::Commands& commands,
                                         const trace::DeviceRayTracer& tracer,
                                         const TracedScene& world) {
  const scene::Environment& map = world.scene.environment;
  PathBuffersOnDevice out;
  LUXEL_TRY_STATUS(upload_surfaces(commands, world, out));
  LUXEL_TRY_STATUS(upload_lights(commands, world, out));
  const PathSetup setup{.world = tracer.world(),
                        .triangles = out.triangles.address,
                        .materials = out.materials.address,
                        .texels = out.texels.address,
                        .linear_of_byte = out.linear_of_byte.address,
                        .emitters = out.emitters.address,
                        .chance_below = out.chance_below.address,
                        .lights = out.lights.address,
                        .row_below = out.row_below.address,
                        .column_below = out.column_below.address,
                        .pixels = out.pixels.address,
                        .background = world.scene.background,
                        .rotation_rad = map.rotation_rad,
                        .map_width = map.empty() ? 0 : map.width,
                        .map_height = map.empty() ? 0 : map.height,
                        .emitter_count = uint32_t(world.emitters.triangles.size()),
                        .light_count = uint32_t(world.scene.lights.size())};
  LUXEL_TRY(out.setup, uploaded<PathSetup>(commands, std::span(&setup, 1)));
  return out;
}

}  // namespace luxel::reference
