// Draws a bake on its surfaces: its light in false colours, its texels, its charts.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "luxel/gpu/pipeline.h"
#include "luxel/pipeline/bake/baked_folder.h"
#include "luxel/scene/scene.h"
#include "luxel/view/draw/device_scene.h"
#include "luxel/view/frame.h"
#include "luxel/view/model/look.h"

namespace luxel::view {

/// Draws all kinds of Show that look into a bake.
Result<gpu::Pipeline> make_overlay_shader(const gpu::Device& device, VkFormat color,
                                          VkSampleCountFlagBits samples);

/// A Look on a device, beside its scene.
struct Overlay {
  gpu::Buffer charts;  ///< of each triangle, in the order of the scene's indices
  gpu::Buffer shown;   ///< what shaders need to know of a frame
  std::deque<gpu::Picture> pictures;
  std::vector<gpu::OwnedSampler> samplers;
  gpu::BindingSets sets;           ///< of each material
  ColorScale irradiance, density;  ///< of frames that have none
};

/// `on_device` is the scene, `look` what look_at() or look_into() gave for it. Both `shader` and
/// `on_device` must outlive it. Errors: no memory on the device, a picture larger than the device's
/// may be.
Result<Overlay> make_overlay(gpu::Commands& commands, const gpu::Pipeline& shader,
                             const scene::Scene& scene, const pipeline::LightmapPages& lightmaps,
                             const Look& look, const DeviceScene& on_device);

/// To be recorded before the drawing begins: what is shown, seen along `forward`.
void set_shown(const gpu::Device& device, VkCommandBuffer commands, const Overlay& overlay,
               const DeviceScene& scene, const Frame& frame, Vec3 forward);
/// All surfaces of the scene, back faces of one-sided materials left out and alpha masks cut.
void draw_overlay(const gpu::Device& device, VkCommandBuffer commands, const gpu::Pipeline& shader,
                  const Overlay& overlay, const DeviceScene& scene,
                  const std::array<float, 16>& clip_from_world);

}  // namespace luxel::view
