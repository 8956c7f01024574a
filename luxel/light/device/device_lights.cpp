#include "luxel/light/device/device_lights.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/scene/light_kinds.h"

namespace luxel::light {
namespace {

// Structs of shaders/lights.glsl.

struct DeviceTriangleLight {
  Vec3 a, b, c, normal;
  Rgb radiance;
  float area_m2;
  uint32_t instance, triangle, piece;
  uint32_t two_sided;
};
static_assert(sizeof(DeviceTriangleLight) == 80);
static_assert(sizeof(LightNode) == 76);

struct DevicePunctualLight {
  Rgb intensity;
  Vec3 position, direction;
  float range_m, cos_inner, cos_outer;
  float disc_height;
  uint32_t kind, has_disc;
};
static_assert(sizeof(DevicePunctualLight) == 60);
static_assert(int(scene::LightKind::point) == 0 && int(scene::LightKind::spot) == 1 &&
              int(scene::LightKind::directional) == 2);

struct Setup {
  trace::DeviceWorld world;
  VkDeviceAddress triangles, nodes, punctual, punctual_order, punctual_nodes;
  VkDeviceAddress bright_texels, guide, below, row_cosine, pixels;
  float diagonal_m, rotation_rad;
  int32_t map_width;
  uint32_t triangle_count, punctual_count, bright_count;
};
static_assert(sizeof(Setup) == 144);

DeviceTriangleLight device_light(const TriangleLight& light) {
  return {light.a,       light.b,        light.c,        light.normal, light.mean_radiance,
          light.area_m2, light.instance, light.triangle, light.piece,  uint32_t(light.two_sided)};
}

DevicePunctualLight device_light(const scene::PunctualLight& light) {
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
          uint32_t(scene::has_disc(light))};
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

bool device_knows(const Lights& lights) {
  return std::ranges::none_of(lights.triangles, &TriangleLight::textured) &&
         std::ranges::all_of(lights.punctual, [](const scene::PunctualLight& light) {
           return light.profile == scene::kNone;
         });
}

Result<DeviceLights> upload_lights(gpu::Commands& commands, const trace::DeviceRayTracer& tracer,
                                   const scene::Scene& scene, const Lights& lights) {
  LUXEL_CHECK(device_knows(lights));
  DeviceLights out;
  LUXEL_TRY(out.triangles,
            (uploaded_as<DeviceTriangleLight, TriangleLight>(commands, lights.triangles)));
  LUXEL_TRY(out.nodes, uploaded<LightNode>(commands, lights.nodes));
  LUXEL_TRY(out.punctual,
            (uploaded_as<DevicePunctualLight, scene::PunctualLight>(commands, lights.punctual)));
  LUXEL_TRY(out.punctual_order, uploaded<uint32_t>(commands, lights.punctual_order));
  LUXEL_TRY(out.punctual_nodes, uploaded<LightNode>(commands, lights.punctual_nodes));
  LUXEL_TRY_STATUS(upload_surroundings(commands, scene, lights.around, out));
  const Setup setup{.world = tracer.world(),
                    .triangles = out.triangles.address,
                    .nodes = out.nodes.address,
                    .punctual = out.punctual.address,
                    .punctual_order = out.punctual_order.address,
                    .punctual_nodes = out.punctual_nodes.address,
                    .bright_texels = out.bright_texels.address,
                    .guide = out.guide.address,
                    .below = out.below.address,
                    .row_cosine = out.row_cosine.address,
                    .pixels = out.pixels.address,
                    .diagonal_m = scene::world_bounds(scene).diagonal(),
                    .rotation_rad = scene.environment.rotation_rad,
                    .map_width = scene.environment.width,
                    .triangle_count = uint32_t(lights.triangles.size()),
                    .punctual_count = uint32_t(lights.punctual.size()),
                    .bright_count = uint32_t(lights.around.bright_texels.size())};
  LUXEL_TRY(out.setup, uploaded<Setup>(commands, std::span(&setup, 1)));
  return out;
}

}  // namespace luxel::light
