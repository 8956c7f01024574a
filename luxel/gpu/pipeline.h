// Shaders ready to run, and the pictures that they look up.
#pragma once

#include <optional>
#include <span>

#include "luxel/gpu/picture.h"

namespace luxel::gpu {

/// Words of SPIR-V, as glslangValidator leaves them (luxel_shaders() in CMake).
using Spirv = std::span<const uint32_t>;

/// Inputs of both kinds of pipelines besides buffers, whose addresses lie in the push constants.
struct Interface {
  uint32_t push_bytes = 0;                 ///< at most 128, which every device has
  std::vector<VkDescriptorType> bindings;  ///< of set 0, numbered from 0
};

struct Pipeline {
  Owned<VkDescriptorSetLayout, &VolkDeviceTable::vkDestroyDescriptorSetLayout> set_layout;
  Owned<VkPipelineLayout, &VolkDeviceTable::vkDestroyPipelineLayout> layout;
  Owned<VkPipeline, &VolkDeviceTable::vkDestroyPipeline> pipeline;
  VkPipelineBindPoint point = VK_PIPELINE_BIND_POINT_COMPUTE;
  VkShaderStageFlags stages = 0;
  Interface interface;
};

/// `constants`: what constant_id 0, 1, ... are in the shader, 32 bits each. Errors: the driver does
/// not take the shader.
Result<Pipeline> make_compute_pipeline(const Device& device, Spirv shader,
                                       const Interface& interface,
                                       const std::vector<uint32_t>& constants = {});

/// Settings by which triangles or lines become pixels. Vertices are read from buffers, not bound.
struct DrawParams {
  Spirv vertex;
  Spirv fragment;  ///< empty: depth alone is drawn
  Interface interface;
  /// Values of constant_id 0, 1, ... in both shaders, 32 bits each.
  std::vector<uint32_t> constants;
  std::vector<VkFormat> colors;   ///< of the pictures that are drawn into
  std::optional<VkFormat> depth;  ///< none: no depth
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkCullModeFlags cull = VK_CULL_MODE_NONE;  ///< counter-clockwise on the screen is the front
  bool writes_depth = true;
  VkCompareOp depth_compare = VK_COMPARE_OP_GREATER;  ///< depth is 1 at the near plane, 0 far away
  bool blends = false;                                ///< by the colour's alpha, premultiplied
};
Result<Pipeline> make_draw_pipeline(const Device& device, const DrawParams& params);

/// Binds a pipeline with its push constants, `Push` as the shader declares it in scalar layout.
template <class Push>
void bind(const Device& device, VkCommandBuffer commands, const Pipeline& pipeline,
          const Push& push) {
  static_assert(sizeof(Push) <= 128);
  device.vk.vkCmdBindPipeline(commands, pipeline.point, pipeline.pipeline.get());
  device.vk.vkCmdPushConstants(commands, pipeline.layout.get(), pipeline.stages, 0, sizeof(Push),
                               &push);
}

/// One binding of a set. Pictures are in VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, those without a
/// sampler (storage images) in VK_IMAGE_LAYOUT_GENERAL.
struct Binding {
  const Picture* picture = nullptr;
  VkSampler sampler = VK_NULL_HANDLE;
};

/// Sets of bindings for pipelines of one interface.
struct BindingSets {
  Owned<VkDescriptorPool, &VolkDeviceTable::vkDestroyDescriptorPool> pool;
  std::vector<VkDescriptorSet> sets;
};
/// `wanted`: for each set all its bindings, as many as the pipeline's interface has.
Result<BindingSets> make_sets(const Device& device, const Pipeline& pipeline,
                              std::span<const std::vector<Binding>> wanted);

void bind_set(const Device& device, VkCommandBuffer commands, const Pipeline& pipeline,
              VkDescriptorSet set);

}  // namespace luxel::gpu
