#include "luxel/view/draw/shapes.h"

#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/shape_shared.h"
#include "luxel/view/shaders/shape.frag.h"
#include "luxel/view/shaders/shape.vert.h"

namespace luxel::view {
namespace {

/// So much nearer to the eye are shapes drawn, over their distance.
constexpr float kShapeNearer = 1e-3f;

using on_device::ShapePush;

static_assert(sizeof(ShapeCorner) == 28);  // as shaders/shape.glsl reads it

gpu::DrawParams shape_params(VkFormat color, VkSampleCountFlagBits samples, bool is_hidden) {
  gpu::DrawParams params = among_surfaces(color, samples);
  params.vertex = shape_vert, params.fragment = shape_frag;
  params.interface.push_bytes = sizeof(ShapePush);
  params.writes_depth = false;
  params.depth_compare = is_hidden ? VK_COMPARE_OP_GREATER_OR_EQUAL : VK_COMPARE_OP_ALWAYS;
  params.blends = true;
  return params;
}

}  // namespace

void add_lines(std::span<const display::Line> lines, float opacity, Shapes& shapes) {
  for (const display::Line& line : lines) {
    shapes.lines.push_back({line.from, line.color, opacity});
    shapes.lines.push_back({line.to, line.color, opacity});
  }
}

Result<DeviceShapes> put_shapes(const gpu::Device& device, const Shapes& shapes) {
  std::vector<ShapeCorner> corners = shapes.triangles;
  corners.insert(corners.end(), shapes.lines.begin(), shapes.lines.end());
  corners.insert(corners.end(), shapes.discs.begin(), shapes.discs.end());
  DeviceShapes out;
  LUXEL_TRY(out.corners, gpu::buffer_with(device, std::as_bytes(std::span(corners)), "lines"));
  out.triangles = uint32_t(shapes.triangles.size() / 3);
  out.lines = uint32_t(shapes.lines.size() / 2), out.discs = uint32_t(shapes.discs.size());
  out.line_width = shapes.line_width, out.disc_width = shapes.disc_width;
  out.is_hidden = shapes.is_hidden;
  return out;
}

Result<ShapeShaders> make_shape_shaders(const gpu::Device& device, VkFormat color,
                                        VkSampleCountFlagBits samples) {
  ShapeShaders out;
  LUXEL_TRY(out.hidden, gpu::make_draw_pipeline(device, shape_params(color, samples, true)));
  LUXEL_TRY(out.on_top, gpu::make_draw_pipeline(device, shape_params(color, samples, false)));
  return out;
}

void draw_shapes(const gpu::Device& device, VkCommandBuffer commands, const ShapeShaders& shaders,
                 const DeviceShapes& shapes, const ShapeView& view) {
  ShapePush push{};
  push.clip_from_world = view.clip_from_world, push.corners = shapes.corners.address;
  push.picture = view.picture, push.curve = uint32_t(view.curve);
  (view.is_parallel ? push.nearer_parallel : push.nearer) = kShapeNearer;
  const gpu::Pipeline& shader = shapes.is_hidden ? shaders.hidden : shaders.on_top;
  const auto draw = [&](uint32_t kind, uint32_t count, uint32_t corners, uint32_t vertices) {
    push.kind = kind;
    if (count > 0) {
      gpu::bind(device, commands, shader, push);
      device.vk.vkCmdDraw(commands, count * vertices, 1, 0, 0);
    }
    push.corners += VkDeviceSize(count) * corners * sizeof(ShapeCorner);
  };
  draw(on_device::kTriangleShapes, shapes.triangles, 3, 3);
  push.width = shapes.line_width;
  draw(on_device::kLineShapes, shapes.lines, 2, 6);
  push.width = shapes.disc_width;
  draw(on_device::kDiscShapes, shapes.discs, 1, 6);
}

}  // namespace luxel::view
