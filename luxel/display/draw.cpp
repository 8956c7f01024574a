#include "luxel/display/draw.h"

#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::display {
namespace {

constexpr int kTile = 16;  ///< pixels along a tile's side: its rays fit in a core's cache

struct PixelTile {
  int x0, y0, x1, y1;
};

PixelTile tile_of(size_t number, const DrawParams& params) {
  const int across = (params.width + kTile - 1) / kTile;
  const int x0 = int(number) % across * kTile, y0 = int(number) / across * kTile;
  return {x0, y0, std::min(x0 + kTile, params.width), std::min(y0 + kTile, params.height)};
}

/// The rays of a tile, pixel after pixel, n x n to each at the centres of a regular grid.
std::vector<trace::Ray> tile_rays(const trace::CameraRays& camera, const PixelTile& tile, int n) {
  std::vector<trace::Ray> rays;
  rays.reserve(size_t((tile.x1 - tile.x0) * (tile.y1 - tile.y0) * n * n));
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x)
      for (int s = 0; s < n * n; ++s) {
        const float px = float(x) + (float(s % n) + 0.5f) / float(n);
        const float py = float(y) + (float(s / n) + 0.5f) / float(n);
        rays.push_back(camera.through(px, py));
      }
  return rays;
}

/// What is seen in a direction in which there is no surface.
using Behind = std::function<Rgb(Vec3)>;

/// Mean over a pixel's samples; summed in double so that equal samples give back their value.
void write_pixel(std::span<const trace::Hit> hits, std::span<const trace::Ray> rays,
                 const SeenAt& seen_at, const Behind& behind, float* pixel) {
  double r = 0, g = 0, b = 0;
  size_t found = 0;
  for (size_t k = 0; k < hits.size(); ++k) {
    const Rgb c = hits[k].found() ? seen_at(hits[k]) : behind(rays[k].direction);
    r += double(c.x), g += double(c.y), b += double(c.z);
    found += hits[k].found() ? 1 : 0;
  }
  const double count = double(hits.size());
  pixel[0] = float(r / count), pixel[1] = float(g / count), pixel[2] = float(b / count);
  pixel[3] = float(double(found) / count);
}

}  // namespace

Rgb seen_radiance(const scene::Scene& scene, const scene::SurfacePoint& p,
                  const IrradianceAt& irradiance_at) {
  if (material_at(scene, p).unlit) {
    const auto color = base_color_at(scene, p);
    return {color[0], color[1], color[2]};
  }
  return emission_at(scene, p) + transport::radiosity_at(scene, p, irradiance_at) * (1.0f / kPi);
}

Result<image::Image> draw_seen(const scene::Scene& scene, const trace::RayTracer& tracer,
                               const scene::Camera& camera, const SeenAt& seen_at,
                               const DrawParams& params, Progress& progress) {
  LUXEL_CHECK(params.width > 0 && params.height > 0 && params.samples_per_axis > 0);
  const trace::CameraRays rays_of(camera, params.width, params.height);
  const size_t tiles =
      size_t((params.width + kTile - 1) / kTile) * size_t((params.height + kTile - 1) / kTile);
  const Behind behind = [&](Vec3 direction) {
    const float most = params.brightest_behind;
    return min(scene::smooth_surroundings_towards(scene, direction), Rgb{most, most, most});
  };
  image::Image picture(params.width, params.height, 4);
  progress.begin("draw", tiles);
  parallel_for(tiles, 1, [&](size_t begin, size_t end) {
    for (size_t number = begin; number < end && !progress.cancelled(); ++number) {
      const PixelTile tile = tile_of(number, params);
      std::vector<trace::Ray> rays = tile_rays(rays_of, tile, params.samples_per_axis);
      const std::vector<trace::Hit> hits = trace::visible_hits(scene, tracer, rays);
      const size_t per_pixel = size_t(params.samples_per_axis * params.samples_per_axis);
      size_t first = 0;
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x, first += per_pixel)
          write_pixel(std::span(hits).subspan(first, per_pixel),
                      std::span(rays).subspan(first, per_pixel), seen_at, behind, picture.at(x, y));
      progress.advance(1);
    }
  });
  progress.finish();
  LUXEL_TRY_STATUS(stopped(progress));
  return picture;
}

Result<image::Image> draw(const scene::Scene& scene, const trace::RayTracer& tracer,
                          const scene::Camera& camera, const IrradianceAt& irradiance_at,
                          const DrawParams& params, Progress& progress) {
  const auto seen_at = [&](const trace::Hit& hit) {
    return seen_radiance(scene, hit.point(), irradiance_at);
  };
  return draw_seen(scene, tracer, camera, seen_at, params, progress);
}

}  // namespace luxel::display
