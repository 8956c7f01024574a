// A line around what is selected.
#pragma once

#include <array>

#include "luxel/gpu/target.h"
#include "luxel/view/draw/device_scene.h"
#include "luxel/view/frame.h"

namespace luxel::view {

struct OutlineShaders {
  gpu::Pipeline mask, line;
};
/// `shown`: the format of what the line is drawn over.
Result<OutlineShaders> make_outline_shaders(const gpu::Device& device, VkFormat shown);

/// Resources for outlines in pictures of one size.
struct Outliner {
  gpu::Target mask;  ///< 8 bits: the share of a pixel that what is outlined covers
  gpu::OwnedSampler sampler;
  gpu::BindingSets sets;
};
Result<Outliner> make_outliner(const gpu::Device& device, const OutlineShaders& shaders,
                               uint32_t width, uint32_t height);

/// Draws what is outlined into the mask, whatever stands before it. `materials`: the sets of
/// bindings of surfaces. To be recorded outside of other drawing.
void draw_mask(const gpu::Device& device, VkCommandBuffer commands, const OutlineShaders& shaders,
               const Outliner& outliner, const DeviceScene& scene,
               std::span<const VkDescriptorSet> materials, const Outline& outline,
               const std::array<float, 16>& clip_from_world);
/// The line, over a picture that is being drawn.
void draw_line(const gpu::Device& device, VkCommandBuffer commands, const OutlineShaders& shaders,
               const Outliner& outliner, const Outline& outline);

}  // namespace luxel::view
