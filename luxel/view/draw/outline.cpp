#include "luxel/view/draw/outline.h"

#include <algorithm>

#include "luxel/view/draw/shadow_shared.h"
#include "luxel/view/shaders/outline.frag.h"
#include "luxel/view/shaders/outline_mask.frag.h"
#include "luxel/view/shaders/screen.vert.h"
#include "luxel/view/shaders/shadow.vert.h"

namespace luxel::view {
namespace {

constexpr VkFormat kMaskFormat = VK_FORMAT_R8_UNORM;
constexpr VkSampleCountFlagBits kMaskSamples = VK_SAMPLE_COUNT_4_BIT;
constexpr VkDescriptorType kMaskLookUp = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;

using on_device::ShadowPush;

/// The push constants of shaders/outline.frag.
struct LinePush {
  Rgb color;
  float width;
};

bool is_outlined(const Outline& outline, uint32_t material) {
  return outline.materials.empty() ||
         std::ranges::find(outline.materials, material) != outline.materials.end();
}

}  // namespace

Result<OutlineShaders> make_outline_shaders(const gpu::Device& device, VkFormat shown) {
  OutlineShaders out;
  gpu::DrawParams mask;
  mask.vertex = shadow_vert, mask.fragment = outline_mask_frag;
  mask.interface = {sizeof(ShadowPush), std::vector<VkDescriptorType>(kLookUps, kMaskLookUp)};
  mask.colors = {kMaskFormat}, mask.samples = kMaskSamples;
  LUXEL_TRY(out.mask, gpu::make_draw_pipeline(device, mask));
  gpu::DrawParams line;
  line.vertex = screen_vert, line.fragment = outline_frag;
  line.interface = {sizeof(LinePush), {kMaskLookUp}};
  line.colors = {shown}, line.blends = true;
  LUXEL_TRY(out.line, gpu::make_draw_pipeline(device, line));
  return out;
}

Result<Outliner> make_outliner(const gpu::Device& device, const OutlineShaders& shaders,
                               uint32_t width, uint32_t height) {
  constexpr VkSamplerAddressMode kClamp = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  Outliner out;
  LUXEL_TRY(out.mask, gpu::make_target(device, {width, height, kMaskFormat, kMaskSamples, false},
                                       "the outline"));
  LUXEL_TRY(out.sampler, gpu::make_sampler(device, {VK_FILTER_LINEAR, kClamp, kClamp}));
  const std::vector<std::vector<gpu::Binding>> sets{{{&out.mask.picture, out.sampler.get()}}};
  LUXEL_TRY(out.sets, gpu::make_sets(device, shaders.line, sets));
  return out;
}

void draw_mask(const gpu::Device& device, VkCommandBuffer commands, const OutlineShaders& shaders,
               const Outliner& outliner, const DeviceScene& scene,
               std::span<const VkDescriptorSet> materials, const Outline& outline,
               const std::array<float, 16>& clip_from_world) {
  gpu::begin_drawing(device, commands, outliner.mask, {0, 0, 0, 0});
  device.vk.vkCmdBindIndexBuffer(commands, scene.indices.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
  ShadowPush push{};
  push.clip_from_world = clip_from_world, push.vertices = scene.vertices.address;
  push.materials = scene.materials.address, push.instances = scene.instances.address;
  for (push.instance = 0; push.instance < scene.mesh_of.size(); ++push.instance) {
    if (outline.instance && *outline.instance != push.instance) continue;
    for (const DrawRange& range : scene.ranges[scene.mesh_of[push.instance]]) {
      if (!is_outlined(outline, range.material)) continue;
      push.material = range.material;
      gpu::bind(device, commands, shaders.mask, push);
      gpu::bind_set(device, commands, shaders.mask, materials[range.material]);
      device.vk.vkCmdDrawIndexed(commands, range.indices, 1, range.first_index, 0, 0);
    }
  }
  gpu::end_drawing(device, commands, outliner.mask, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

void draw_line(const gpu::Device& device, VkCommandBuffer commands, const OutlineShaders& shaders,
               const Outliner& outliner, const Outline& outline) {
  const auto height = float(outliner.mask.params.height);
  const LinePush push{outline.color, std::clamp(height / 240, 1.5f, 5.0f)};
  gpu::bind(device, commands, shaders.line, push);
  gpu::bind_set(device, commands, shaders.line, outliner.sets.sets[0]);
  device.vk.vkCmdDraw(commands, 3, 1, 0, 0);
}

}  // namespace luxel::view
