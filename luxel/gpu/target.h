// Pictures that are drawn into.
#pragma once

#include <optional>

#include "luxel/gpu/picture.h"

namespace luxel::gpu {

/// A picture with colour and depth, of several samples per pixel where it is asked for.
struct TargetParams {
  uint32_t width = 0, height = 0;
  VkFormat color = VK_FORMAT_R8G8B8A8_UNORM;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  bool has_depth = true;
};

struct Target {
  TargetParams params;
  std::optional<Picture> samples;  ///< of more than one per pixel
  std::optional<Picture> depth;    ///< VK_FORMAT_D32_SFLOAT
  Picture picture;                 ///< what is looked at, the mean of the samples
};

Result<Target> make_target(const Device& device, const TargetParams& params, std::string_view what);

/// Begins to draw into a target, whose content is lost: it is `clear`, linear, and infinitely far.
/// The whole target is the viewport; y is down, as in pictures.
void begin_drawing(const Device& device, VkCommandBuffer commands, const Target& target,
                   std::array<float, 4> clear);
/// Ends it; the target's picture gets into the layout `next`.
void end_drawing(const Device& device, VkCommandBuffer commands, const Target& target,
                 VkImageLayout next);

/// Begins to draw depth alone into a part of a picture that is DEPTH_ATTACHMENT_OPTIMAL. What was
/// there is lost: that part is infinitely far, and it is the viewport. vkCmdEndRenderingKHR ends
/// it.
void begin_drawing_depth(const Device& device, VkCommandBuffer commands, const Picture& depth,
                         const VkRect2D& part);

}  // namespace luxel::gpu
