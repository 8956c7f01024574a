// Triangles whose irradiance is a quadratic function, evaluated at each pixel. [Hardt96, section
// 3.4]
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "luxel/display/quadratic_view.h"
#include "luxel/gpu/pipeline.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// A display::QuadraticMesh on a device.
struct DeviceQuadratics {
  gpu::Buffer triangles;  ///< as shaders/quadratic.glsl has them
  uint32_t count = 0;
};

/// `group`: for each triangle a number of what it is part of, which exact light of pixels names.
/// Errors: no triangles, no memory on the device.
Result<DeviceQuadratics> put_quadratics(const gpu::Device& device,
                                        const display::QuadraticMesh& mesh,
                                        std::span<const uint32_t> group);

/// For pictures of these formats.
Result<gpu::Pipeline> make_quadratic_shader(const gpu::Device& device, VkFormat color,
                                            VkSampleCountFlagBits samples);

/// Exact irradiance of the pixels of a picture: (E, group) of each, the group's bits as
/// uintBitsToFloat gives them; another group than that of the surface: it is not known.
struct ExactPixels {
  gpu::Buffer pixels;
  uint32_t width = 0;
};

/// Draws them as the painter draws surfaces; `exact` may be none.
void draw_quadratics(const gpu::Device& device, VkCommandBuffer commands,
                     const gpu::Pipeline& shader, const DeviceQuadratics& mesh,
                     const std::optional<ExactPixels>& exact,
                     const std::array<float, 16>& clip_from_world, const Frame& frame);

}  // namespace luxel::view
