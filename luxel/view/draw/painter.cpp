#include "luxel/view/draw/painter.h"

#include <cmath>
#include <cstring>

#include "luxel/display/tone_map.h"
#include "luxel/image/half.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/view/draw/among_surfaces.h"
#include "luxel/view/draw/behind_shared.h"
#include "luxel/view/draw/beside_shared.h"
#include "luxel/view/draw/mark_shared.h"
#include "luxel/view/shaders/behind.frag.h"
#include "luxel/view/shaders/behind.vert.h"
#include "luxel/view/shaders/beside.frag.h"
#include "luxel/view/shaders/mark.frag.h"
#include "luxel/view/shaders/mark.vert.h"
#include "luxel/view/shaders/screen.frag.h"
#include "luxel/view/shaders/screen.vert.h"

namespace luxel::view {
namespace {

constexpr VkFormat kExposed = VK_FORMAT_R16G16B16A16_SFLOAT;
constexpr VkFormat kShown = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;  // which every device has
constexpr Rgb kBehindColors{0.806952f, 0.806952f, 0.806952f};      // 232 of 255 on a screen
constexpr float kNear = 1e-5f;  // the near plane, over the scene's diagonal
constexpr VkDescriptorType kLookUp = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;

using on_device::BehindPush, on_device::MarkPush;

/// The push constants of shaders/screen.frag.
struct ScreenPush {
  uint32_t curve;
};

/// The camera of trace::CameraRays as a matrix. Depth is 1 at the near plane and 0 infinitely far,
/// where floats are finest; parallel rays start at the eye and see as far as the scene goes.
std::array<float, 16> clip_from_world(const trace::CameraRays& c, const Box3& bounds) {
  const float diagonal = bounds.diagonal();
  const Vec3 x = c.right / dot(c.right, c.right), y = c.up / dot(c.up, c.up);
  const auto row = [&](Vec3 v, float w) { return std::array{v.x, v.y, v.z, w - dot(v, c.eye)}; };
  std::array<std::array<float, 4>, 4> rows{
      row(x, 0), row(-y, 0), {0, 0, 0, kNear * diagonal}, row(c.forward, 0)};
  if (c.orthographic) {
    const float far = diagonal + length(bounds.centre() - c.eye);
    rows[2] = row(c.forward / -far, 1);
    rows[3] = {0, 0, 0, 1};
  }
  std::array<float, 16> out;
  for (size_t r = 0; r < 4; ++r)
    for (size_t k = 0; k < 4; ++k) out[4 * k + r] = rows[r][k];
  return out;
}

gpu::DrawParams behind_params() {
  gpu::DrawParams params = among_surfaces(kExposed, kSamples);
  params.vertex = behind_vert, params.fragment = behind_frag;
  params.interface = {sizeof(BehindPush), {kLookUp}};
  params.writes_depth = false;
  params.depth_compare = VK_COMPARE_OP_EQUAL;  // where no surface is
  return params;
}

gpu::DrawParams screen_params() {
  gpu::DrawParams params;
  params.vertex = screen_vert, params.fragment = screen_frag;
  params.interface = {sizeof(ScreenPush), {kLookUp}};
  params.colors = {kShown};
  return params;
}

/// Two pictures and what each was made from, and the map of FLIP.
gpu::DrawParams beside_params() {
  gpu::DrawParams params = screen_params();
  params.fragment = beside_frag;
  params.interface = {sizeof(on_device::BesidePush), std::vector<VkDescriptorType>(5, kLookUp)};
  return params;
}

gpu::DrawParams mark_params() {
  gpu::DrawParams params;
  params.vertex = mark_vert, params.fragment = mark_frag;
  params.interface.push_bytes = sizeof(MarkPush);
  params.colors = {kShown};
  params.blends = true;
  return params;
}

void draw_marks(const gpu::Device& device, VkCommandBuffer commands, const Canvas& canvas,
                std::span<const Mark> marks) {
  const gpu::TargetParams& size = canvas.painter.shown.params;
  for (const Mark& mark : marks) {
    gpu::bind(device, commands, canvas.shaders.mark,
              MarkPush{mark.from,
                       mark.to,
                       {float(size.width), float(size.height)},
                       mark.radius,
                       mark.edge_width,
                       mark.color,
                       mark.edge});
    device.vk.vkCmdDraw(commands, 6, 1, 0, 0);
  }
}

/// True: it shows colours that stand for something, not light.
bool shows_colors(Show show) { return looks_into_bake(show) && show != Show::checker; }

/// The surroundings, or a light grey behind colours that stand for something.
BehindPush behind_of(const trace::CameraRays& camera, const DeviceScene& scene, const Frame& frame,
                     bool has_overlay) {
  BehindPush out{camera.forward,
                 camera.orthographic ? Vec3{} : camera.right,
                 camera.orthographic ? Vec3{} : camera.up,
                 scene.background * scene.surroundings_factor,
                 scene.surroundings_factor * scene.surroundings_scale,
                 scene.rotation_rad,
                 frame.exposure,
                 uint32_t(frame.show)};
  if (!has_overlay || !shows_colors(frame.show)) return out;
  out.background = kBehindColors;
  out.map_scale = {}, out.exposure = 1;
  return out;
}

}  // namespace

Result<Shaders> make_shaders(const gpu::Device& device) {
  Shaders out;
  LUXEL_TRY(out.surfaces, SurfaceShaders::make(device, kExposed, kSamples));
  LUXEL_TRY(out.behind, gpu::make_draw_pipeline(device, behind_params()));
  LUXEL_TRY(out.screen, gpu::make_draw_pipeline(device, screen_params()));
  LUXEL_TRY(out.beside, gpu::make_draw_pipeline(device, beside_params()));
  LUXEL_TRY(out.overlay, make_overlay_shader(device, kExposed, kSamples));
  LUXEL_TRY(out.probes, make_probe_shader(device, kExposed, kSamples));
  LUXEL_TRY(out.quadratic, make_quadratic_shader(device, kExposed, kSamples));
  LUXEL_TRY(out.shapes, make_shape_shaders(device, kExposed, kSamples));
  LUXEL_TRY(out.mark, gpu::make_draw_pipeline(device, mark_params()));
  LUXEL_TRY(out.technique, make_technique_shaders(device, kExposed, kSamples));
  LUXEL_TRY(out.inset, make_inset_shader(device, kShown));
  LUXEL_TRY(out.outline, make_outline_shaders(device, kShown));
  return out;
}

Result<Painter> make_painter(const gpu::Device& device, const Shaders& shaders,
                             const DeviceScene& scene, uint32_t width, uint32_t height) {
  Painter out;
  LUXEL_TRY(out.exposed,
            gpu::make_target(device, {width, height, kExposed, kSamples, true}, "the picture"));
  LUXEL_TRY(out.shown,
            gpu::make_target(device, {width, height, kShown, VK_SAMPLE_COUNT_1_BIT, false},
                             "the picture"));
  LUXEL_TRY(out.sampler, gpu::make_sampler(device, {VK_FILTER_NEAREST}));
  LUXEL_TRY(out.materials, gpu::make_sets(device, shaders.surfaces.any(), scene.bindings));
  const std::vector<std::vector<gpu::Binding>> surroundings{{scene.surroundings}};
  LUXEL_TRY(out.surroundings, gpu::make_sets(device, shaders.behind, surroundings));
  const std::vector<std::vector<gpu::Binding>> exposed{{{&out.exposed.picture, out.sampler.get()}}};
  LUXEL_TRY(out.to_screen, gpu::make_sets(device, shaders.screen, exposed));
  LUXEL_TRY(out.outliner, make_outliner(device, shaders.outline, width, height));
  return out;
}

namespace {

bool has_technique(const Additions& more, const Frame& frame) {
  return more.techniques && frame.technique;
}

/// A frame shows light, or colours that stand for something: those are shown as they are.
bool shows_light(const Additions& more, const Frame& frame, bool has_overlay) {
  return has_technique(more, frame)
             ? view::is_light(*frame.technique)
             : frame.show != Show::colour && !(has_overlay && shows_colors(frame.show));
}

/// The surfaces, or what is drawn instead of them.
void draw_surfaces_or_else(const gpu::Device& device, VkCommandBuffer commands,
                           const Canvas& canvas, const Additions& more,
                           const std::array<float, 16>& clip, const Frame& frame) {
  const Shaders& shaders = canvas.shaders;
  if (canvas.overlay != nullptr && looks_into_bake(frame.show))
    draw_overlay(device, commands, shaders.overlay, *canvas.overlay, canvas.scene, clip);
  else if (has_technique(more, frame))
    draw_technique(device, commands, shaders.technique, *more.techniques, canvas.scene,
                   {clip, canvas.painter.materials.sets}, frame);
  else if (!more.instead && !more.no_surfaces)
    draw_surfaces(device, commands, shaders.surfaces, canvas.scene,
                  {clip, canvas.painter.materials.sets}, frame);
  else if (!more.no_surfaces)
    draw_quadratics(device, commands, shaders.quadratic, *more.instead, more.exact, clip, frame);
}

/// Draws the exposed picture as a screen shows it, and all that lies over it.
void show_exposed(const gpu::Device& device, VkCommandBuffer commands, const Canvas& canvas,
                  const Additions& more, display::ToneMap curve, const Frame& frame) {
  const Painter& painter = canvas.painter;
  const gpu::TargetParams& size = painter.exposed.params;
  gpu::begin_drawing(device, commands, painter.shown, {0, 0, 0, 1});
  gpu::bind(device, commands, canvas.shaders.screen, ScreenPush{uint32_t(curve)});
  gpu::bind_set(device, commands, canvas.shaders.screen, painter.to_screen.sets[0]);
  device.vk.vkCmdDraw(commands, 3, 1, 0, 0);
  if (frame.outline)
    draw_line(device, commands, canvas.shaders.outline, painter.outliner, *frame.outline);
  draw_marks(device, commands, canvas, frame.marks);
  if (more.inset)
    draw_inset(device, commands, canvas.shaders.inset, *more.inset, size.width, size.height);
  gpu::end_drawing(device, commands, painter.shown, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
}

}  // namespace

void paint(const gpu::Device& device, VkCommandBuffer commands, const Canvas& canvas,
           const Frame& frame) {
  const Painter& painter = canvas.painter;
  const DeviceScene& scene = canvas.scene;
  const Additions none, &more = canvas.additions ? *canvas.additions : none;
  const gpu::TargetParams& size = painter.exposed.params;
  const trace::CameraRays camera(frame.camera, int(size.width), int(size.height));
  const bool has_overlay = canvas.overlay != nullptr && looks_into_bake(frame.show);
  const std::array<float, 16> clip = clip_from_world(camera, scene.bounds);
  light_now(scene).eye = camera.eye;
  if (has_overlay)
    set_shown(device, commands, *canvas.overlay, scene, frame, normalize(camera.forward));
  gpu::begin_drawing(device, commands, painter.exposed, {0, 0, 0, 0});
  draw_surfaces_or_else(device, commands, canvas, more, clip, frame);
  if (canvas.probes && frame.shows_probes)
    draw_probes(device, commands, canvas.shaders.probes, *canvas.probes,
                has_overlay ? canvas.overlay : nullptr, frame, clip);
  const bool is_light = shows_light(more, frame, has_overlay);
  BehindPush behind = behind_of(camera, scene, frame, has_overlay);
  if (is_light && !more.no_surfaces && behind.background == Rgb{} && behind.map_scale == Rgb{})
    behind.background = display::kGreyOfNothing, behind.exposure = 1;
  gpu::bind(device, commands, canvas.shaders.behind, behind);
  gpu::bind_set(device, commands, canvas.shaders.behind, painter.surroundings.sets[0]);
  device.vk.vkCmdDraw(commands, 3, 1, 0, 0);
  const display::ToneMap curve = is_light ? frame.curve : display::ToneMap::clamp;
  for (const DeviceShapes& shapes : more.shapes)
    draw_shapes(device, commands, canvas.shaders.shapes, shapes,
                {clip, camera.orthographic, {float(size.width), float(size.height)}, curve});
  gpu::end_drawing(device, commands, painter.exposed, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  if (frame.outline)
    draw_mask(device, commands, canvas.shaders.outline, painter.outliner, scene,
              painter.materials.sets, *frame.outline, clip);
  show_exposed(device, commands, canvas, more, curve, frame);
  gpu::change_layout(device, commands, painter.exposed.picture,
                     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                     VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
}

Result<image::Image8> shown_pixels(gpu::Commands& commands, const gpu::Target& shown) {
  LUXEL_TRY(const std::vector<std::byte> pixels, gpu::pixels_of(commands, shown.picture));
  image::Image8 out;
  out.width = int(shown.params.width), out.height = int(shown.params.height);
  out.channels = 3;
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 != 3) out.data.push_back(uint8_t(pixels[i]));
  return out;
}

Result<image::Image8> painted(gpu::Commands& commands, const Canvas& canvas, const Frame& frame) {
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer buffer) { paint(commands.device(), buffer, canvas, frame); }));
  return shown_pixels(commands, canvas.painter.shown);
}

Result<image::Image> last_radiance(gpu::Commands& commands, const Painter& painter,
                                   float exposure) {
  LUXEL_TRY(const std::vector<std::byte> pixels, gpu::pixels_of(commands, painter.exposed.picture));
  image::Image out(int(painter.exposed.params.width), int(painter.exposed.params.height), 4);
  for (size_t i = 0; i < out.data.size(); ++i) {
    uint16_t half = 0;
    std::memcpy(&half, pixels.data() + 2 * i, 2);
    out.data[i] = image::from_half(half) / (i % 4 == 3 ? 1 : exposure);
  }
  return out;
}

Result<image::Image> painted_radiance(gpu::Commands& commands, const Canvas& canvas,
                                      const Frame& frame) {
  LUXEL_TRY_STATUS(commands.run(
      [&](VkCommandBuffer buffer) { paint(commands.device(), buffer, canvas, frame); }));
  return last_radiance(commands, canvas.painter, frame.exposure);
}

}  // namespace luxel::view
