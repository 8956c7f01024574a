#include "luxel/gpu/pipeline.h"

#include "luxel/base/check.h"

namespace luxel::gpu {
namespace {

using OwnedShader = Owned<VkShaderModule, &VolkDeviceTable::vkDestroyShaderModule>;

Result<OwnedShader> make_shader(const Device& device, Spirv words) {
  auto info = structure<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = words.size_bytes();
  info.pCode = words.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateShaderModule(device.device, &info, nullptr, &shader),
                         "cannot create a shader"));
  return OwnedShader(device, shader);
}

VkPipelineShaderStageCreateInfo stage_of(VkShaderStageFlagBits stage, const OwnedShader& shader) {
  auto info = structure<VkPipelineShaderStageCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  info.stage = stage;
  info.module = shader.get();
  info.pName = "main";
  return info;
}

/// Constants 0, 1, ... of a shader.
std::vector<VkSpecializationMapEntry> entries_of(const std::vector<uint32_t>& constants) {
  std::vector<VkSpecializationMapEntry> out;
  for (uint32_t k = 0; k < constants.size(); ++k)
    out.push_back({k, uint32_t(k * sizeof(uint32_t)), sizeof(uint32_t)});
  return out;
}

VkSpecializationInfo specialization(const std::vector<VkSpecializationMapEntry>& entries,
                                    const std::vector<uint32_t>& constants) {
  return {uint32_t(entries.size()), entries.data(), constants.size() * sizeof(uint32_t),
          constants.data()};
}

/// All but the pipeline itself.
Result<Pipeline> with_layout(const Device& device, const Interface& interface,
                             VkShaderStageFlags stages) {
  LUXEL_CHECK(interface.push_bytes <= 128);
  Pipeline out;
  out.interface = interface, out.stages = stages;
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const VkDescriptorType type : interface.bindings)
    bindings.push_back({uint32_t(bindings.size()), type, 1, stages, nullptr});
  auto set_info = structure<VkDescriptorSetLayoutCreateInfo>(
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  set_info.bindingCount = uint32_t(bindings.size());
  set_info.pBindings = bindings.data();
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      check(device.vk.vkCreateDescriptorSetLayout(device.device, &set_info, nullptr, &set_layout),
            "cannot create a pipeline"));
  out.set_layout = {device, set_layout};
  const VkPushConstantRange range{stages, 0, interface.push_bytes};
  auto info = structure<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout;
  info.pushConstantRangeCount = interface.push_bytes > 0;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreatePipelineLayout(device.device, &info, nullptr, &layout),
                         "cannot create a pipeline"));
  out.layout = {device, layout};
  return out;
}

}  // namespace

Result<Pipeline> make_compute_pipeline(const Device& device, Spirv shader,
                                       const Interface& interface,
                                       const std::vector<uint32_t>& constants) {
  LUXEL_TRY(Pipeline out, with_layout(device, interface, VK_SHADER_STAGE_COMPUTE_BIT));
  LUXEL_TRY(const OwnedShader compute, make_shader(device, shader));
  auto info =
      structure<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = stage_of(VK_SHADER_STAGE_COMPUTE_BIT, compute);
  const std::vector<VkSpecializationMapEntry> entries = entries_of(constants);
  const VkSpecializationInfo values = specialization(entries, constants);
  info.stage.pSpecializationInfo = &values;
  info.layout = out.layout.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateComputePipelines(device.device, VK_NULL_HANDLE, 1, &info,
                                                            nullptr, &pipeline),
                         "cannot create a compute shader"));
  out.pipeline = {device, pipeline};
  return out;
}

Result<Pipeline> make_draw_pipeline(const Device& device, const DrawParams& params) {
  constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  LUXEL_TRY(Pipeline out, with_layout(device, params.interface, kStages));
  out.point = VK_PIPELINE_BIND_POINT_GRAPHICS;
  LUXEL_TRY(const OwnedShader vertex, make_shader(device, params.vertex));
  std::vector stages{stage_of(VK_SHADER_STAGE_VERTEX_BIT, vertex)};
  OwnedShader fragment;
  if (!params.fragment.empty()) {
    LUXEL_TRY(fragment, make_shader(device, params.fragment));
    stages.push_back(stage_of(VK_SHADER_STAGE_FRAGMENT_BIT, fragment));
  }
  const std::vector<VkSpecializationMapEntry> entries = entries_of(params.constants);
  const VkSpecializationInfo constants = specialization(entries, params.constants);
  for (VkPipelineShaderStageCreateInfo& stage : stages) stage.pSpecializationInfo = &constants;
  const auto nothing_bound = structure<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  auto assembly = structure<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = params.topology;
  auto viewport = structure<VkPipelineViewportStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  auto raster = structure<VkPipelineRasterizationStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.cullMode = params.cull;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  auto multisample = structure<VkPipelineMultisampleStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  multisample.rasterizationSamples = params.samples;
  auto depth = structure<VkPipelineDepthStencilStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = params.depth.has_value();
  depth.depthWriteEnable = params.depth && params.writes_depth;
  depth.depthCompareOp = params.depth_compare;
  VkPipelineColorBlendAttachmentState blend{};
  blend.blendEnable = params.blends;
  blend.srcColorBlendFactor = blend.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  blend.dstColorBlendFactor = blend.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  blend.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                         VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  const std::vector<VkPipelineColorBlendAttachmentState> blends(params.colors.size(), blend);
  auto blending = structure<VkPipelineColorBlendStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blending.attachmentCount = uint32_t(blends.size());
  blending.pAttachments = blends.data();
  constexpr VkDynamicState kDynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic = structure<VkPipelineDynamicStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = kDynamic;
  auto rendering =
      structure<VkPipelineRenderingCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
  rendering.colorAttachmentCount = uint32_t(params.colors.size());
  rendering.pColorAttachmentFormats = params.colors.data();
  rendering.depthAttachmentFormat = params.depth.value_or(VK_FORMAT_UNDEFINED);
  auto info =
      structure<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.pNext = &rendering;
  info.stageCount = uint32_t(stages.size()), info.pStages = stages.data();
  info.pVertexInputState = &nothing_bound;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blending;
  info.pDynamicState = &dynamic;
  info.layout = out.layout.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateGraphicsPipelines(device.device, VK_NULL_HANDLE, 1,
                                                             &info, nullptr, &pipeline),
                         "cannot create a shader that draws"));
  out.pipeline = {device, pipeline};
  return out;
}

Result<BindingSets> make_sets(const Device& device, const Pipeline& pipeline,
                              std::span<const std::vector<Binding>> wanted) {
  BindingSets out;
  if (wanted.empty()) return out;
  std::vector<VkDescriptorPoolSize> sizes;
  for (const VkDescriptorType type : pipeline.interface.bindings)
    sizes.push_back({type, uint32_t(wanted.size())});
  auto pool_info =
      structure<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool_info.maxSets = uint32_t(wanted.size());
  pool_info.poolSizeCount = uint32_t(sizes.size());
  pool_info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(
      check(device.vk.vkCreateDescriptorPool(device.device, &pool_info, nullptr, &pool),
            "cannot bind the shaders' pictures"));
  out.pool = {device, pool};
  const std::vector<VkDescriptorSetLayout> layouts(wanted.size(), pipeline.set_layout.get());
  auto info =
      structure<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pool;
  info.descriptorSetCount = uint32_t(layouts.size());
  info.pSetLayouts = layouts.data();
  out.sets.resize(wanted.size());
  LUXEL_TRY_STATUS(check(device.vk.vkAllocateDescriptorSets(device.device, &info, out.sets.data()),
                         "cannot bind the shaders' pictures"));
  for (size_t i = 0; i < wanted.size(); ++i) {
    LUXEL_CHECK(wanted[i].size() == pipeline.interface.bindings.size());
    for (size_t b = 0; b < wanted[i].size(); ++b) {
      const Binding& binding = wanted[i][b];
      const VkDescriptorImageInfo image{binding.sampler, binding.picture->view.get(),
                                        binding.sampler == VK_NULL_HANDLE
                                            ? VK_IMAGE_LAYOUT_GENERAL
                                            : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
      auto write = structure<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
      write.dstSet = out.sets[i];
      write.dstBinding = uint32_t(b);
      write.descriptorCount = 1;
      write.descriptorType = pipeline.interface.bindings[b];
      write.pImageInfo = &image;
      device.vk.vkUpdateDescriptorSets(device.device, 1, &write, 0, nullptr);
    }
  }
  return out;
}

void bind_set(const Device& device, VkCommandBuffer commands, const Pipeline& pipeline,
              VkDescriptorSet set) {
  device.vk.vkCmdBindDescriptorSets(commands, pipeline.point, pipeline.layout.get(), 0, 1, &set, 0,
                                    nullptr);
}

}  // namespace luxel::gpu
