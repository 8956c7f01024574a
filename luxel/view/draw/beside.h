// Two scenes from one view, put together into one picture.
#pragma once

#include "luxel/view/draw/painter.h"

namespace luxel::view {

/// Resources for pictures of a second scene, and of both.
struct Pair {
  Painter second;
  gpu::Target shown;   ///< both together, as Painter::shown
  gpu::Picture flip;   ///< what compare() found, in false colours
  gpu::Buffer colors;  ///< of shaders/beside.frag
  gpu::BindingSets sets;
};

/// `first` draws the first scene and must outlive it; both get pictures of its size.
Result<Pair> make_pair(gpu::Commands& commands, const Shaders& shaders, const Painter& first,
                       const DeviceScene& second);

/// Draws both. Where they are to be compared, false colours and texels become light.
void paint_both(const gpu::Device& device, VkCommandBuffer commands, const Canvas& first,
                const Canvas& second, const Frame& frame);
/// Puts them together in pair.shown, which is then in the layout TRANSFER_SRC_OPTIMAL, as all
/// pictures of both are before and after. `frame` has a Beside.
void put_together(const gpu::Device& device, VkCommandBuffer commands, const Canvas& first,
                  const Pair& pair, const Frame& frame);

/// FLIP of the pictures that were drawn last: its mean. Its map is what put_together() shows.
/// Errors: no memory, the device is lost.
Result<float> compare(gpu::Commands& commands, const Painter& first, const Pair& pair);

/// All of it, and the picture: 3 channels.
Result<image::Image8> painted_together(gpu::Commands& commands, const Canvas& first,
                                       const Canvas& second, const Pair& pair, const Frame& frame);

}  // namespace luxel::view
