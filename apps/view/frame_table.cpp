#include "apps/view/frame_table.h"

#include <fmt/format.h>

namespace luxel::view_window {

Status add_row(Screen& screen, float milliseconds, const view::ShownScene& shown,
               FrameTable& table) {
  LUXEL_TRY(const std::vector<std::byte> pixels,
            gpu::pixels_of(*screen.commands, screen.painter.shown.picture));
  double sum = 0;
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 != 3) sum += double(uint8_t(pixels[i]));
  const double most = 255 * 0.75 * double(pixels.size());
  table.rows.push_back({milliseconds, sum / most, shown.numbers.samples, shown.has_light});
  return {};
}

std::string csv_of(const FrameTable& table) {
  std::string out = "frame,milliseconds,brightness,rays_per_texel,has_light\n";
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const FrameTable::Row& row = table.rows[i];
    out += fmt::format("{},{:.2f},{:.5f},{:.0f},{:d}\n", i, row.milliseconds, row.brightness,
                       row.samples, row.has_light);
  }
  return out;
}

}  // namespace luxel::view_window
