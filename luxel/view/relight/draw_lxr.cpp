#include "luxel/view/relight/draw_lxr.h"

#include "luxel/view/draw/painter.h"

namespace luxel::view {

Result<image::Image8> draw_lxr(gpu::Commands& commands, OpenedLxr& opened,
                               const LxrPicture& wanted) {
  const ReadScene& read = *opened.read;
  const int width = wanted.width > 0 ? wanted.width : read.width;
  const int height = wanted.height > 0 ? wanted.height : read.height;
  const Box3 bounds = scene::world_bounds(read.scene);
  const PlaceSeen place_seen = place_seen_in(read.scene, *read.tracer, width, height);
  Walk walk = begin_walk(read.first, bounds, width, height, place_seen);
  LampDesk desk = begin_desk(opened.lamps, bounds);
  if (wanted.events) {
    LUXEL_TRY_STATUS(check_lamps(*wanted.events, opened.lamps, wanted.play_name));
    play_with_lamps(*wanted.events, place_seen, walk, desk);
  }
  LUXEL_TRY(RelitScene relit, lxr_shown(commands, opened));
  DeviceScene& scene = relit.shown.device;
  LUXEL_TRY_STATUS(
      follow_lamps(commands, desk.lamps, opened, relit.direct, scene).map([](LightTimes) {}));
  const gpu::Device& device = commands.device();
  LUXEL_TRY(const Shaders shaders, make_shaders(device));
  LUXEL_TRY(const Painter painter,
            make_painter(device, shaders, scene, uint32_t(width), uint32_t(height)));
  walk.shown.marks = marks_of(desk, walk);
  return painted(commands, {shaders, painter, scene}, walk.shown);
}

}  // namespace luxel::view
