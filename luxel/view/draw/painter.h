// Draws a scene that lies on a graphics device.
#pragma once

#include <optional>
#include <vector>

#include "luxel/gpu/pipeline.h"
#include "luxel/gpu/target.h"
#include "luxel/image/codec.h"
#include "luxel/image/image.h"
#include "luxel/view/draw/device_scene.h"
#include "luxel/view/draw/inset.h"
#include "luxel/view/draw/outline.h"
#include "luxel/view/draw/overlay.h"
#include "luxel/view/draw/probe_drawing.h"
#include "luxel/view/draw/quadratic.h"
#include "luxel/view/draw/shapes.h"
#include "luxel/view/draw/surface_drawing.h"
#include "luxel/view/draw/technique_drawing.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// The shaders of all pictures.
struct Shaders {
  SurfaceShaders surfaces;
  gpu::Pipeline behind, screen, mark, overlay, beside, quadratic, inset, probes;
  ShapeShaders shapes;
  TechniqueShaders technique;
  OutlineShaders outline;
};
/// Takes some tenths of a second on the processor.
Result<Shaders> make_shaders(const gpu::Device& device);

/// Resources for pictures of one size.
struct Painter {
  gpu::Target exposed;  ///< halves: exposed radiance, and the share of the pixel that is a surface
  gpu::Target shown;    ///< 8 bits, display values
  gpu::BindingSets materials, surroundings, to_screen;
  gpu::OwnedSampler sampler;
  Outliner outliner;
};
/// For this scene.
Result<Painter> make_painter(const gpu::Device& device, const Shaders& shaders,
                             const DeviceScene& scene, uint32_t width, uint32_t height);

/// Things drawn instead of a scene's surfaces, and after all of them.
struct Additions {
  std::optional<DeviceQuadratics> instead;
  std::optional<ExactPixels> exact;  ///< of `instead`
  bool no_surfaces = false;
  std::vector<DeviceShapes> shapes;            ///< in this order
  std::optional<DeviceTechniques> techniques;  ///< instead, where Frame::technique says so
  std::optional<DeviceInset> inset;            ///< over the picture
};

/// The scene of a picture and all that draws it. These must live until it is drawn.
struct Canvas {
  const Shaders& shaders;
  const Painter& painter;
  const DeviceScene& scene;
  const Overlay* overlay = nullptr;  ///< without one no frame looks into the bake
  const Additions* additions = nullptr;
  const DeviceProbes* probes = nullptr;
};

/// Records the drawing of a frame; the painter's `shown` is then in the layout
/// TRANSFER_SRC_OPTIMAL, as `exposed` is. The back faces of one-sided materials are left out and
/// alpha masks cut, as display::draw does.
void paint(const gpu::Device& device, VkCommandBuffer commands, const Canvas& canvas,
           const Frame& frame);

/// The pixels of a picture for a screen that is in the layout TRANSFER_SRC_OPTIMAL: 3 channels.
Result<image::Image8> shown_pixels(gpu::Commands& commands, const gpu::Target& shown);
/// Draws a frame and reads the picture back: 3 channels.
Result<image::Image8> painted(gpu::Commands& commands, const Canvas& canvas, const Frame& frame);
/// The exposed radiance of what was drawn last, divided by its exposure: 4 channels.
Result<image::Image> last_radiance(gpu::Commands& commands, const Painter& painter, float exposure);
/// Draws a frame and reads the exposed radiance back, divided by the exposure: 4 channels, as
/// display::draw gives them.
Result<image::Image> painted_radiance(gpu::Commands& commands, const Canvas& canvas,
                                      const Frame& frame);

}  // namespace luxel::view
