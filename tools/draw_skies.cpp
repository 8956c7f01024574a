// Draws clear skies with the sun at several heights as one sheet: how docs/images/sky.png was made.
//   build/release/bin/luxel_draw_skies docs/images/sky.png
// and, on the standard output, the table of docs/method/lights.md.
// Each is the picture's part from the top to 10 degrees below the horizon, with an exposure of its
// own; the sun (without its disc) stands in the middle.
#include <cstdio>
#include <vector>

#include "luxel/base/file.h"
#include "luxel/display/contact_sheet.h"
#include "luxel/display/tone_map.h"
#include "luxel/scene/sky.h"

namespace {

using namespace luxel;

image::Image cut(const scene::Environment& map, int rows) {
  image::Image out(map.width, rows, 3);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < map.width; ++x)
      out.set_rgb(x, y, map.radiance[size_t(y) * size_t(map.width) + size_t(x)]);
  return out;
}

scene::Sky sky_of(float elevation_deg, int height) {
  const float e = elevation_deg * kPi / 180;
  scene::SkyParams params;
  params.towards_sun = {std::cos(e), std::sin(e), 0};
  params.height = height;
  return scene::make_sky(params);
}

float sky_lux(const scene::Sky& sky) {
  return luminance(scene::horizontal_irradiance(sky.radiance));
}

display::Tile tile_of(float elevation_deg) {
  const scene::Sky sky = sky_of(elevation_deg, 256);
  const image::Image shown = cut(sky.radiance, sky.radiance.height * 100 / 180);
  return {fmt::format("{:g} deg: sun {:.3g} lx, sky {:.3g} lx", elevation_deg,
                      luminance(sky.sun_illuminance), sky_lux(sky)),
          display::tone_map(shown, display::auto_exposure(shown))};
}

void print_table() {
  std::puts(
      "| sun, degrees | sun, facing it [lx] | its colour r:g:b | sky, horizontal [lx] |\n"
      "|---|---|---|---|");
  for (const float e : {90.0f, 60.0f, 40.0f, 20.0f, 10.0f, 3.0f, 0.0f, -3.0f, -6.0f, -12.0f}) {
    const scene::Sky sky = sky_of(e, 128);
    const Rgb sun = sky.sun_illuminance;
    const float most = max_component(sun);
    std::puts(fmt::format("| {:g} | {:.4g} | {} | {:.3g} |", e, luminance(sun),
                          most > 0 ? fmt::format("{:.2f} : {:.2f} : {:.2f}", sun.x / most,
                                                 sun.y / most, sun.z / most)
                                   : "-",
                          sky_lux(sky))
                  .c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: luxel_draw_skies FILE.png\n", stderr);
    return 2;
  }
  std::vector<display::Tile> tiles;
  for (const float elevation : {60.0f, 20.0f, 3.0f, -3.0f}) tiles.push_back(tile_of(elevation));
  const Status written =
      write_file_atomically(argv[1], image::encode_png(display::contact_sheet(tiles)));
  print_table();
  if (written) return 0;
  std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return 1;
}
