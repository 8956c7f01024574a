// Surfaces by techniques of local illumination and of hemicube radiosity, in shaders.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "luxel/gpu/pipeline.h"
#include "luxel/view/draw/device_scene.h"
#include "luxel/view/draw/surface_corners.h"
#include "luxel/view/frame.h"

namespace luxel::view {

struct TechniqueShaders {
  gpu::Pipeline one_sided, double_sided;
};
/// For pictures of these formats.
Result<TechniqueShaders> make_technique_shaders(const gpu::Device& device, VkFormat color,
                                                VkSampleCountFlagBits samples);

/// Triangles on a device.
struct DeviceCorners {
  gpu::Buffer corners;
  std::vector<CornerRange> ranges;
};

/// Buffers that techniques draw from, beside a DeviceScene, which has the materials.
struct DeviceTechniques {
  DeviceCorners own;                  ///< the scene's triangles
  std::optional<DeviceCorners> mesh;  ///< of the hemicube solver; none: `own` is drawn, dark
  gpu::Buffer elements;               ///< E and reflectance of each of its elements
  gpu::Buffer highlights;             ///< of each material
  gpu::Buffer looking;                ///< who looks, and the light
  scene::Scene lamps;                 ///< the scene's lights and nothing else
};

/// Without a mesh. Errors: no memory on the device.
Result<DeviceTechniques> put_techniques(const gpu::Device& device, const scene::Scene& scene);
/// The mesh of the solver, its elements still dark. Nothing may still draw it. Errors: no memory on
/// the device.
Status put_mesh(const gpu::Device& device, const SurfaceCorners& mesh,
                std::span<const Rgb> reflectance, DeviceTechniques& out);
/// E of all elements of the mesh [W/m^2]. Nothing may still draw it.
void put_irradiance(std::span<const Rgb> irradiance, DeviceTechniques& out);

/// View and bindings by which techniques draw.
struct TechniqueView {
  std::array<float, 16> clip_from_world{};     ///< column by column
  std::span<const VkDescriptorSet> materials;  ///< what the scene's materials look up
};
/// All surfaces by frame.technique, which there is. Back faces of one-sided materials are left out
/// and alpha masks cut. Nothing may still draw it.
void draw_technique(const gpu::Device& device, VkCommandBuffer commands,
                    const TechniqueShaders& shaders, const DeviceTechniques& techniques,
                    const DeviceScene& scene, const TechniqueView& view, const Frame& frame);

}  // namespace luxel::view
