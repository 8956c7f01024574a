#include "luxel/view/relight/draw_lxr.h"

namespace luxel::view {

bool is_lxr(const std::filesystem::path& file) { return file.extension() == ".lxr"; }

Result<image::Image8> draw_lxr(gpu::Commands& commands, OpenedLxr& opened,
                               const std::optional<Play>& events, const std::string& play_name,
                               int width, int height) {
  const Box3 bounds = scene::world_bounds(opened.scene);
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(opened.scene));
  const PlaceSeen place_seen = place_seen_in(opened.scene, tracer, width, height);
  Walk walk = begin_walk(opened.first, bounds, width, height, place_seen);
  LampDesk desk = begin_desk(opened.lamps, bounds);
  if (events) {
    LUXEL_TRY_STATUS(check_lamps(*events, opened.lamps, play_name));
    play_with_lamps(*events, place_seen, walk, desk);
  }
  LUXEL_TRY(RelitScene relit, put_on_device(commands, opened));
  LUXEL_TRY_STATUS(follow_lamps(commands, desk.lamps, opened, relit));
  const gpu::Device& device = commands.device();
  LUXEL_TRY(const Shaders shaders, make_shaders(device));
  LUXEL_TRY(const Painter painter,
            make_painter(device, shaders, relit.scene, uint32_t(width), uint32_t(height)));
  walk.shown.marks = marks_of(desk, walk);
  return painted(commands, {shaders, painter, relit.scene}, walk.shown);
}

}  // namespace luxel::view
