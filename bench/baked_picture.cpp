#include "bench/baked_picture.h"

#include <cstdio>
#include <cstdlib>
// jpeglib.h needs cstdio before it.
#include <jpeglib.h>

#include "luxel/base/check.h"
#include "luxel/display/smooth_lookup.h"
#include "luxel/display/tone_map.h"
#include "luxel/image/flip.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::bench {

Result<image::Image> draw_baked(const pipeline::Bake& bake, const trace::RayTracer& tracer,
                                const scene::Camera& camera, std::span<const Rgb> irradiance,
                                const display::DrawParams& params, Progress& progress) {
  const transport::TexelField field{&bake.atlas, &bake.map, irradiance};
  return display::draw(
      bake.scene, tracer, camera,
      [&](const scene::SurfacePoint& p) { return display::smooth_irradiance_at(field, p); }, params,
      progress);
}

image::Image on_screen(const image::Image& radiance, float exposure) {
  image::Image out(radiance.width, radiance.height, 3);
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x)
      out.set_rgb(x, y, display::compress(radiance.rgb(x, y) * exposure));
  return out;
}

double mean_flip(const image::Image& a, const image::Image& b) {
  const image::Image map = image::flip(a, b);
  double sum = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) sum += double(map.at(x, y)[0]);
  return sum / (double(map.width) * map.height);
}

std::vector<std::byte> jpeg_of(const image::Image8& picture) {
  constexpr int kQuality = 90;
  LUXEL_CHECK(picture.channels == 3);
  jpeg_compress_struct library{};
  jpeg_error_mgr errors{};
  library.err = jpeg_std_error(&errors);
  jpeg_create_compress(&library);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&library, &bytes, &size);
  library.image_width = JDIMENSION(picture.width),
  library.image_height = JDIMENSION(picture.height);
  library.input_components = 3, library.in_color_space = JCS_RGB;
  jpeg_set_defaults(&library);
  jpeg_set_quality(&library, kQuality, TRUE);
  jpeg_start_compress(&library, TRUE);
  while (library.next_scanline < library.image_height) {
    // The library reads rows, but takes them as its own.
    auto* row = const_cast<uint8_t*>(
        &picture.data[size_t(library.next_scanline) * 3 * size_t(picture.width)]);
    jpeg_write_scanlines(&library, &row, 1);
  }
  jpeg_finish_compress(&library);
  const auto* begin = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> file(begin, begin + size);
  jpeg_destroy_compress(&library);
  std::free(bytes);
  return file;
}

}  // namespace luxel::bench
