#include "bench/baked_picture.h"

#include "luxel/display/tone_map.h"
#include "luxel/image/flip.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::bench {

Result<image::Image> draw_baked(const pipeline::Bake& bake, const trace::RayTracer& tracer,
                                std::span<const Rgb> irradiance, const display::DrawParams& params,
                                Progress& progress) {
  const transport::TexelField field{&bake.atlas, &bake.map, irradiance};
  return display::draw(
      bake.scene, tracer, bake.view.camera,
      [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); }, params,
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

}  // namespace luxel::bench
