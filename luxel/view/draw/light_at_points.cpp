#include "luxel/view/draw/light_at_points.h"

#include "luxel/gpu/commands.h"
#include "luxel/view/shaders/points.comp.h"

namespace luxel::view {
namespace {

using on_device::kPointThreads, on_device::PointsPush;

}  // namespace

bool can_light_points(const gpu::Device& device, size_t points) {
  return (points + kPointThreads - 1) / kPointThreads <= device.limits.maxComputeWorkGroupCount[0];
}

Result<LightAtPoints> make_light_at_points(const gpu::Device& device, const DeviceScene& scene,
                                           std::span<const LitPoint> points) {
  LightAtPoints out;
  out.count = uint32_t(points.size());
  constexpr VkDescriptorType kLookUp = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  LUXEL_TRY(out.shader, gpu::make_compute_pipeline(device, points_comp,
                                                   {sizeof(PointsPush), {kLookUp, kLookUp}}));
  const std::vector<std::vector<gpu::Binding>> maps{{scene.shadow_maps, scene.shadow_depth}};
  LUXEL_TRY(out.maps, gpu::make_sets(device, out.shader, maps));
  LUXEL_TRY(out.points,
            gpu::buffer_with(device, std::as_bytes(points), "the points that lamps light"));
  LUXEL_TRY(out.irradiance, gpu::make_buffer(device, points.size() * sizeof(Rgb),
                                             gpu::Access::to_host, "the light of points"));
  return out;
}

void light_points(const gpu::Device& device, VkCommandBuffer commands, const DeviceScene& scene,
                  const LightAtPoints& at) {
  gpu::bind(
      device, commands, at.shader,
      PointsPush{scene.light_now.address, at.points.address, at.irradiance.address, at.count});
  gpu::bind_set(device, commands, at.shader, at.maps.sets[0]);
  device.vk.vkCmdDispatch(commands, (at.count + kPointThreads - 1) / kPointThreads, 1, 1);
  gpu::full_barrier(device, commands);
}

}  // namespace luxel::view
