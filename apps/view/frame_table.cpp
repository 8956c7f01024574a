#include "apps/view/frame_table.h"

#include <fmt/format.h>

namespace luxel::view_window {

Status add_row(Screen& screen, float milliseconds, Subject& subject, FrameTable& table) {
  if (!table.first) table.first = Clock::now();
  const double at_s = seconds_since(*table.first);
  LUXEL_TRY(const std::vector<std::byte> pixels,
            gpu::pixels_of(*screen.commands, screen.painter.shown.picture));
  double sum = 0;
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 != 3) sum += double(uint8_t(pixels[i]));
  const double most = 255 * 0.75 * double(pixels.size());
  const view::ShownScene& shown = subject.shown();
  table.rows.push_back({milliseconds, sum / most, shown.numbers.samples, shown.has_light,
                        subject.light_times(), at_s, subject.edits()});
  return {};
}

std::string csv_of(const FrameTable& table) {
  std::string out =
      "frame,milliseconds,brightness,rays_per_texel,has_light,direct_ms,bounces_ms,"
      "places_ms,map_ms,shadows_ms,at_s,edits\n";
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const FrameTable::Row& row = table.rows[i];
    const view::LightTimes& light = row.light;
    out +=
        fmt::format("{},{:.2f},{:.5f},{:.0f},{:d},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.4f},{}\n",
                    i, row.milliseconds, row.brightness, row.samples, row.has_light, light.direct,
                    light.bounces, light.places, light.map, light.shadows, row.at_s, row.edits);
  }
  return out;
}

}  // namespace luxel::view_window
