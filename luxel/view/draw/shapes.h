// Triangles, lines and discs in plain colours, among the surfaces of a picture.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "luxel/display/lines.h"
#include "luxel/gpu/pipeline.h"
#include "luxel/view/frame.h"

namespace luxel::view {

/// A corner of a shape.
struct ShapeCorner {
  Vec3 place;          ///< [m]
  Rgb color{1, 1, 1};  ///< display values; very bright ones get darker, very pure ones paler
  float opacity = 1;
  friend bool operator==(const ShapeCorner&, const ShapeCorner&) = default;
};

/// Shapes that are drawn together: triangles first, then lines, then discs, each in its order.
struct Shapes {
  std::vector<ShapeCorner> triangles;  ///< three for each; seen from both sides
  std::vector<ShapeCorner> lines;      ///< two for each
  std::vector<ShapeCorner> discs;      ///< one for each: its centre
  float line_width = 1.5f;             ///< [pixels]
  float disc_width = 5;                ///< their diameter [pixels]
  /// True: things before the shapes hide them. Surfaces on which the shapes lie do not: a
  /// thousandth of the distance to the eye does not count.
  bool is_hidden = true;

  bool empty() const { return triangles.empty() && lines.empty() && discs.empty(); }
};

/// Adds lines to shapes, with this opacity.
void add_lines(std::span<const display::Line> lines, float opacity, Shapes& shapes);

/// Shapes on a device.
struct DeviceShapes {
  gpu::Buffer corners;  ///< of triangles, lines and discs
  uint32_t triangles = 0, lines = 0, discs = 0;
  float line_width = 1, disc_width = 1;
  bool is_hidden = true;
};

/// Errors: no memory on the device. `shapes` are not empty.
Result<DeviceShapes> put_shapes(const gpu::Device& device, const Shapes& shapes);

struct ShapeShaders {
  gpu::Pipeline hidden, on_top;
};
/// For pictures of these formats.
Result<ShapeShaders> make_shape_shaders(const gpu::Device& device, VkFormat color,
                                        VkSampleCountFlagBits samples);

/// View of the picture that shapes are drawn into.
struct ShapeView {
  std::array<float, 16> clip_from_world{};  ///< column by column
  bool is_parallel = false;                 ///< depth is linear in the distance
  Vec2 picture;                             ///< its size [pixels]
  display::ToneMap curve{};                 ///< by which it is shown
};
/// Draws into a picture of exposed radiance after all of its surfaces.
void draw_shapes(const gpu::Device& device, VkCommandBuffer commands, const ShapeShaders& shaders,
                 const DeviceShapes& shapes, const ShapeView& view);

}  // namespace luxel::view
