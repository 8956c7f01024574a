// The surfaces of a scene under their light.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "luxel/gpu/pipeline.h"
#include "luxel/view/draw/device_scene.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// Guards shaders of surfaces: those that leave out what some surfaces have not. Where pixels are
/// drawn side by side, as on a processor, a branch that none of them takes costs as much as one
/// that is taken: without lamps pictures take a third of the time.
class SurfaceShaders {
 public:
  /// With one shader, which draws all surfaces. They are drawn into pictures of this format.
  static Result<SurfaceShaders> make(const gpu::Device& device, VkFormat color,
                                     VkSampleCountFlagBits samples);
  SurfaceShaders();
  SurfaceShaders(SurfaceShaders&&) noexcept;
  SurfaceShaders& operator=(SurfaceShaders&&) noexcept;
  ~SurfaceShaders();

  /// One whose bindings are those of all.
  const gpu::Pipeline& any() const;
  /// The shader for a material's surfaces of an instance in the next picture of this scene. It is
  /// made when it is first asked for, by one thread, which takes some hundredths of a second. Where
  /// it cannot be made it is the one that draws all.
  const gpu::Pipeline& for_surfaces(const DeviceScene& scene, uint32_t instance,
                                    uint32_t material) const;

 private:
  struct Made;
  std::unique_ptr<Made> made_;
};

/// View and bindings by which surfaces are drawn.
struct SurfaceView {
  std::array<float, 16> clip_from_world{};  ///< column by column
  std::span<const VkDescriptorSet> sets{};  ///< of each material, of SurfaceShaders::any()
};

/// Records their drawing. The back faces of one-sided materials are left out and alpha masks cut.
void draw_surfaces(const gpu::Device& device, VkCommandBuffer commands,
                   const SurfaceShaders& shaders, const DeviceScene& scene, const SurfaceView& view,
                   const Frame& frame);

}  // namespace luxel::view
