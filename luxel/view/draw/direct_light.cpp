#include "luxel/view/draw/direct_light.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "luxel/gpu/target.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/view/draw/shadow_shared.h"
#include "luxel/view/shaders/shadow.frag.h"
#include "luxel/view/shaders/shadow.vert.h"

namespace luxel::view {
namespace {

using on_device::ShadowPush;

static_assert(sizeof(ShadowMap) == 84);  // as shaders/scene.glsl reads it
static_assert(int(scene::PunctualLight::Kind::point) == 0 &&
              int(scene::PunctualLight::Kind::spot) == 1 &&
              int(scene::PunctualLight::Kind::directional) == 2);

/// Wider discs have the shadows of this one [rad].
constexpr float kWidestDisc = 0.5f;

gpu::DrawParams shadow_params(bool is_masked) {
  gpu::DrawParams params;
  params.vertex = shadow_vert;
  params.interface.push_bytes = sizeof(ShadowPush);
  if (is_masked) {
    params.fragment = shadow_frag;
    params.interface.bindings = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER};
  }
  params.depth = VK_FORMAT_D32_SFLOAT;
  return params;
}

on_device::Lamp device_lamp(const scene::PunctualLight& l) {
  const float outer = std::cos(l.outer_cone_rad), inner = std::cos(l.inner_cone_rad);
  return {l.intensity,
          uint32_t(l.kind),
          l.position,
          l.range_m,
          l.direction,
          outer,
          1 / std::max(1e-3f, inner - outer),
          0,
          0,
          0,
          scene::has_disc(l) ? std::tan(std::min(l.angular_radius_rad, kWidestDisc)) : 0};
}

/// Values in a buffer that is made anew where they have no room.
template <class Value>
Status put_values(const gpu::Device& device, const std::vector<Value>& values,
                  std::string_view what, gpu::Buffer& buffer) {
  const size_t size = std::max<size_t>(1, values.size()) * sizeof(Value);
  if (buffer.size < size) {
    LUXEL_TRY(buffer, gpu::make_buffer(device, size, gpu::Access::from_host, what));
  }
  if (!values.empty()) std::memcpy(buffer.mapped, values.data(), values.size() * sizeof(Value));
  return {};
}

void draw_map(const gpu::Device& device, VkCommandBuffer commands, const DeviceScene& scene,
              const DirectLight& direct, const ShadowMap& map) {
  const auto side = uint32_t(map.side);
  gpu::begin_drawing_depth(device, commands, *scene.shadow_maps.picture,
                           {{int32_t(map.corner.x), int32_t(map.corner.y)}, {side, side}});
  device.vk.vkCmdBindIndexBuffer(commands, scene.indices.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
  ShadowPush push{};
  push.clip_from_world = map.clip_from_world, push.vertices = scene.vertices.address;
  push.materials = scene.materials.address, push.instances = scene.instances.address;
  for (push.instance = 0; push.instance < scene.mesh_of.size(); ++push.instance)
    for (const DrawRange& range : scene.ranges[scene.mesh_of[push.instance]]) {
      push.material = range.material;
      const bool is_masked = scene.is_masked[range.material];
      const gpu::Pipeline& pipeline = is_masked ? direct.masked : direct.solid;
      gpu::bind(device, commands, pipeline, push);
      if (is_masked)
        gpu::bind_set(device, commands, pipeline, direct.colour_maps.sets[range.material]);
      device.vk.vkCmdDrawIndexed(commands, range.indices, 1, range.first_index, 0, 0);
    }
  device.vk.vkCmdEndRenderingKHR(commands);
}

}  // namespace

Result<DirectLight> make_direct_light(const gpu::Device& device, const DeviceScene& scene) {
  DirectLight out;
  LUXEL_TRY(out.solid, gpu::make_draw_pipeline(device, shadow_params(false)));
  LUXEL_TRY(out.masked, gpu::make_draw_pipeline(device, shadow_params(true)));
  std::vector<std::vector<gpu::Binding>> maps;
  for (const std::vector<gpu::Binding>& material : scene.bindings) maps.push_back({material[1]});
  LUXEL_TRY(out.colour_maps, gpu::make_sets(device, out.masked, maps));
  return out;
}

Status set_lamps(const gpu::Device& device, std::span<const scene::PunctualLight> lamps,
                 const trace::CameraRays* eye, DirectLight& direct, DeviceScene& scene) {
  direct.plan = plan_shadows(lamps, scene.bounds, scene.shadow_maps.picture->params.width, eye);
  scene.has_soft_shadows = std::any_of(lamps.begin(), lamps.end(), scene::has_disc);
  std::vector<on_device::Lamp> values;
  for (size_t i = 0; i < lamps.size(); ++i) {
    values.push_back(device_lamp(lamps[i]));
    values[i].first_map = direct.plan.first_map[i];
    values[i].map_count = direct.plan.map_count[i];
    values[i].looks_all_round = direct.plan.looks_all_round[i];
  }
  LUXEL_TRY_STATUS(put_values(device, values, "the lamps", direct.lamps));
  LUXEL_TRY_STATUS(put_values(device, direct.plan.maps, "the maps of shadows", direct.maps));
  on_device::LightNow& now = light_now(scene);
  now.lamp_count = uint32_t(lamps.size());
  now.lamps = direct.lamps.address, now.maps = direct.maps.address;
  return {};
}

void draw_shadow_maps(const gpu::Device& device, VkCommandBuffer commands, const DeviceScene& scene,
                      DirectLight& direct) {
  const std::vector<ShadowMap>& wanted = direct.plan.maps;
  if (wanted == direct.drawn) return;
  const gpu::Picture& picture = *scene.shadow_maps.picture;
  gpu::change_layout(device, commands, picture, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                     VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
  for (size_t k = 0; k < wanted.size(); ++k)
    if (k >= direct.drawn.size() || direct.drawn[k] != wanted[k])
      draw_map(device, commands, scene, direct, wanted[k]);
  gpu::change_layout(device, commands, picture, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  direct.drawn = wanted;
}

}  // namespace luxel::view
