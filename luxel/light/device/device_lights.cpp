#include "luxel/light/device/device_lights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/light/device/direct_light_shared.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/trace/vulkan/device_pictures.h"

namespace luxel::light {
namespace {

static_assert(sizeof(LightNode) == 76);  // as shaders/lights.glsl reads it
static_assert(int(scene::LightProfile::Angles::c) == 0 &&
              int(scene::LightProfile::Angles::b) == 1 && int(scene::LightProfile::Angles::a) == 2);
static_assert(int(scene::LightKind::point) == 0 && int(scene::LightKind::spot) == 1 &&
              int(scene::LightKind::directional) == 2);

on_device::TriangleLight device_light(const TriangleLight& light) {
  return {light.a,
          light.b,
          light.c,
          light.normal,
          light.mean_radiance,
          light.area_m2,
          light.size_m,
          light.instance,
          light.triangle,
          light.piece,
          uint32_t(light.two_sided),
          0};
}

on_device::PunctualLight device_light(const scene::PunctualLight& light) {
  // 1 - cos(angle) without cancellation.
  const float s = std::sin(0.5f * light.angular_radius_rad);
  return {light.intensity,
          light.position,
          light.direction,
          light.range_m,
          std::cos(light.inner_cone_rad),
          std::cos(light.outer_cone_rad),
          2 * s * s,
          uint32_t(light.kind),
          uint32_t(scene::has_disc(light)),
          light.side,
          light.profile == scene::kNone ? 0 : light.profile + 1};
}

template <class T>
Result<gpu::Buffer> uploaded(gpu::Commands& commands, std::span<const T> values) {
  return gpu::uploaded_or_one(commands, values, "the buffer of lights");
}

template <class To, class From>
Result<gpu::Buffer> uploaded_as(gpu::Commands& commands, std::span<const From> lights) {
  std::vector<To> values;
  for (const From& light : lights) values.push_back(device_light(light));
  return uploaded<To>(commands, values);
}

const scene::Material& material_of(const scene::Scene& scene, const TriangleLight& light) {
  return scene::material_at(scene, {light.instance, light.triangle, {}});
}

on_device::LightTexture light_texture(const scene::Scene& scene, const TriangleLight& light,
                                      trace::DevicePictures& pictures) {
  const scene::Material& material = material_of(scene, light);
  const scene::Mesh& mesh = scene.meshes[scene.instances[light.instance].mesh];
  on_device::LightTexture out{material.emission,
                              pictures.placed(mesh, light.triangle, material.emission_texture)};
  const std::array<Vec2, 3> corners = out.picture.places;
  for (size_t k = 0; k < 3; ++k) {
    Barycentric at = light.part[k];
    if (light.flipped) std::swap(at.u, at.v);
    out.picture.places[k] = corners[0] * (1 - at.u - at.v) + corners[1] * at.u + corners[2] * at.v;
  }
  return out;
}

Status upload_triangles(gpu::Commands& commands, const scene::Scene& scene, const Lights& lights,
                        DeviceLights& out) {
  std::vector<uint32_t> texels;
  trace::DevicePictures pictures(scene, texels);
  std::vector<on_device::LightTexture> textures;
  std::vector<on_device::TriangleLight> triangles;
  for (const TriangleLight& light : lights.triangles) {
    triangles.push_back(device_light(light));
    if (!light.textured) continue;
    textures.push_back(light_texture(scene, light, pictures));
    triangles.back().texture_number = uint32_t(textures.size());
  }
  LUXEL_TRY(out.triangles, uploaded<on_device::TriangleLight>(commands, triangles));
  LUXEL_TRY(out.textures, uploaded<on_device::LightTexture>(commands, textures));
  LUXEL_TRY(out.texels, uploaded<uint32_t>(commands, texels));
  const std::array<float, 256> linear = trace::linear_of_bytes();
  LUXEL_TRY(out.linear_of_byte, uploaded<float>(commands, linear));
  return {};
}

Status upload_profiles(gpu::Commands& commands, const Lights& lights, DeviceLights& out) {
  std::vector<on_device::LightProfile> profiles;
  std::vector<float> values;
  for (const scene::LightProfile& p : lights.profiles) {
    profiles.push_back({uint32_t(p.angles), uint32_t(p.vertical_rad.size()),
                        uint32_t(p.horizontal_rad.size()), uint32_t(values.size())});
    for (const auto* some : {&p.vertical_rad, &p.horizontal_rad, &p.candela})
      values.insert(values.end(), some->begin(), some->end());
  }
  LUXEL_TRY(out.profiles, uploaded<on_device::LightProfile>(commands, profiles));
  LUXEL_TRY(out.profile_values, uploaded<float>(commands, values));
  return {};
}

Status upload_surroundings(gpu::Commands& commands, const scene::Scene& scene,
                           const Surroundings& around, DeviceLights& out) {
  LUXEL_TRY(out.bright_texels, uploaded<uint32_t>(commands, around.bright_texels));
  LUXEL_TRY(out.guide, uploaded<uint32_t>(commands, around.guide));
  LUXEL_TRY(out.below, uploaded<double>(commands, around.below));
  LUXEL_TRY(out.row_cosine, uploaded<double>(commands, around.row_cosine));
  LUXEL_TRY(out.pixels, uploaded<Rgb>(commands, scene.environment.radiance));
  return {};
}

}  // namespace

bool device_knows(const scene::Scene& scene, const Lights& lights) {
  return std::ranges::none_of(lights.triangles, [&](const TriangleLight& light) {
    return light.textured && scene::lets_light_through(material_of(scene, light));
  });
}

Result<DeviceLights> upload_lights(gpu::Commands& commands, const trace::DeviceRayTracer& tracer,
                                   const scene::Scene& scene, const Lights& lights) {
  LUXEL_CHECK(device_knows(scene, lights));
  DeviceLights out;
  LUXEL_TRY_STATUS(upload_triangles(commands, scene, lights, out));
  LUXEL_TRY_STATUS(upload_profiles(commands, lights, out));
  LUXEL_TRY(out.nodes, uploaded<LightNode>(commands, lights.nodes));
  LUXEL_TRY(out.punctual, (uploaded_as<on_device::PunctualLight, scene::PunctualLight>(
                              commands, lights.punctual)));
  LUXEL_TRY(out.punctual_order, uploaded<uint32_t>(commands, lights.punctual_order));
  LUXEL_TRY(out.punctual_nodes, uploaded<LightNode>(commands, lights.punctual_nodes));
  LUXEL_TRY_STATUS(upload_surroundings(commands, scene, lights.around, out));
  const on_device::LightSetup setup{.world = tracer.world(),
                                    .triangles = out.triangles.address,
                                    .nodes = out.nodes.address,
                                    .textures = out.textures.address,
                                    .texels = out.texels.address,
                                    .linear_of_byte = out.linear_of_byte.address,
                                    .punctual = out.punctual.address,
                                    .punctual_order = out.punctual_order.address,
                                    .punctual_nodes = out.punctual_nodes.address,
                                    .profiles = out.profiles.address,
                                    .profile_values = out.profile_values.address,
                                    .bright_texels = out.bright_texels.address,
                                    .guide = out.guide.address,
                                    .below = out.below.address,
                                    .row_cosine = out.row_cosine.address,
                                    .pixels = out.pixels.address,
                                    .rotation_rad = scene.environment.rotation_rad,
                                    .map_width = scene.environment.width,
                                    .triangle_count = uint32_t(lights.triangles.size()),
                                    .punctual_count = uint32_t(lights.punctual.size()),
                                    .bright_count = uint32_t(lights.around.bright_texels.size())};
  LUXEL_TRY(out.setup, uploaded<on_device::LightSetup>(commands, std::span(&setup, 1)));
  return out;
}

}  // namespace luxel::light
