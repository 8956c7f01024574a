#include "luxel/gpu/target.h"

#include <array>

namespace luxel::gpu {
namespace {

/// A depth that is cleared, of no picture yet.
VkRenderingAttachmentInfo infinitely_far() {
  auto depth = structure<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  depth.clearValue.depthStencil = {0, 0};  // DrawParams::depth_compare
  return depth;
}

/// Begins to draw into a part, which is the viewport; null: no colour, no depth.
void begin_rendering(const Device& device, VkCommandBuffer commands,
                     const VkRenderingAttachmentInfo* color, const VkRenderingAttachmentInfo* depth,
                     const VkRect2D& part) {
  auto info = structure<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
  info.renderArea = part;
  info.layerCount = 1;
  info.colorAttachmentCount = color != nullptr;
  info.pColorAttachments = color;
  info.pDepthAttachment = depth;
  device.vk.vkCmdBeginRenderingKHR(commands, &info);
  const VkViewport viewport{float(part.offset.x),
                            float(part.offset.y),
                            float(part.extent.width),
                            float(part.extent.height),
                            0,
                            1};
  device.vk.vkCmdSetViewport(commands, 0, 1, &viewport);
  device.vk.vkCmdSetScissor(commands, 0, 1, &part);
}

}  // namespace

Result<Target> make_target(const Device& device, const TargetParams& params,
                           std::string_view what) {
  Target out;
  out.params = params;
  PictureParams picture{params.color,
                        params.width,
                        params.height,
                        1,
                        VK_SAMPLE_COUNT_1_BIT,
                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                            VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
  LUXEL_TRY(out.picture, make_picture(device, picture, what));
  picture.samples = params.samples;
  if (params.samples != VK_SAMPLE_COUNT_1_BIT) {
    picture.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    LUXEL_TRY(out.samples, make_picture(device, picture, what));
  }
  if (params.has_depth) {
    picture.format = VK_FORMAT_D32_SFLOAT;
    picture.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    LUXEL_TRY(out.depth, make_picture(device, picture, what));
  }
  return out;
}

void begin_drawing(const Device& device, VkCommandBuffer commands, const Target& target,
                   std::array<float, 4> clear) {
  constexpr VkImageLayout kColor = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  constexpr VkImageLayout kDepth = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
  change_layout(device, commands, target.picture, VK_IMAGE_LAYOUT_UNDEFINED, kColor);
  auto color = structure<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  color.imageView = target.picture.view.get();
  color.imageLayout = kColor;
  color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  color.clearValue.color = {{clear[0], clear[1], clear[2], clear[3]}};
  if (target.samples) {
    change_layout(device, commands, *target.samples, VK_IMAGE_LAYOUT_UNDEFINED, kColor);
    color.imageView = target.samples->view.get();
    color.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
    color.resolveImageView = target.picture.view.get();
    color.resolveImageLayout = kColor;
  }
  VkRenderingAttachmentInfo depth = infinitely_far();
  if (target.depth) {
    change_layout(device, commands, *target.depth, VK_IMAGE_LAYOUT_UNDEFINED, kDepth);
    depth.imageView = target.depth->view.get();
    depth.imageLayout = kDepth;
  }
  begin_rendering(device, commands, &color, target.depth ? &depth : nullptr,
                  {{0, 0}, {target.params.width, target.params.height}});
}

void begin_drawing_depth(const Device& device, VkCommandBuffer commands, const Picture& depth,
                         const VkRect2D& part) {
  VkRenderingAttachmentInfo attachment = infinitely_far();
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  attachment.imageView = depth.view.get();
  attachment.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
  begin_rendering(device, commands, nullptr, &attachment, part);
}

void end_drawing(const Device& device, VkCommandBuffer commands, const Target& target,
                 VkImageLayout next) {
  device.vk.vkCmdEndRenderingKHR(commands);
  change_layout(device, commands, target.picture, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, next);
}

}  // namespace luxel::gpu
