#include "luxel/display/draw.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::display {
namespace {

constexpr size_t kPixelsAtOnce = 256;  ///< pixels whose rays fit in a core's cache
/// A step between neighbours that can be seen, as a share of the brighter one: four of 255 in
/// bright places.
constexpr float kSeenStep = 1.0f / 32;

/// The rays of pixels, n x n to each at the centres of a regular grid.
std::vector<trace::Ray> rays_of(const trace::CameraRays& camera, std::span<const uint32_t> pixels,
                                int n) {
  std::vector<trace::Ray> rays;
  rays.reserve(pixels.size() * size_t(n * n));
  for (const uint32_t pixel : pixels) {
    const uint32_t width = uint32_t(camera.width);
    for (int s = 0; s < n * n; ++s)
      rays.push_back(camera.through(float(pixel % width) + (float(s % n) + 0.5f) / float(n),
                                    float(pixel / width) + (float(s / n) + 0.5f) / float(n)));
  }
  return rays;
}

/// True if a step from one pixel to the other can be seen.
bool differ(const float* a, const float* b) {
  float most = 0, difference = 0;
  for (int c = 0; c < 3; ++c) {
    most = std::max({most, a[c], b[c]});
    difference = std::max(difference, std::abs(a[c] - b[c]));
  }
  return difference > kSeenStep * most || a[3] != b[3];
}

/// The neighbours of pixels that differ from them and were not taken before.
std::vector<uint32_t> take_differing(const image::Image& picture, std::span<const uint32_t> pixels,
                                     std::vector<bool>& taken) {
  std::vector<uint32_t> out;
  const float* data = picture.data.data();
  const uint32_t width = uint32_t(picture.width);
  const auto look = [&](uint32_t from, uint32_t to) {
    if (taken[to] || !differ(data + 4 * size_t(from), data + 4 * size_t(to))) return;
    taken[to] = true;
    out.push_back(to);
  };
  for (const uint32_t i : pixels) {
    if (i % width > 0) look(i, i - 1);
    if (i % width + 1 < width) look(i, i + 1);
    if (i >= width) look(i, i - width);
    if (i + width < taken.size()) look(i, i + width);
  }
  return out;
}

/// The share of what a ray sees that lies behind surfaces, below which nothing more is looked for.
constexpr float kLeastLeft = 1.0f / 512;

/// The radiance that a ray sees, and the share of it that surfaces cover.
struct SeenByRay {
  Rgb radiance{};
  float covered = 0;
};

/// From front to back, each surface covers its share of what lies behind it. [Porter84]
std::vector<SeenByRay> seen_along(const scene::Scene& scene, const trace::RayTracer& tracer,
                                  std::span<const trace::Ray> from, bool backs,
                                  const SeenAt& seen_at, const SeenBehind& behind) {
  std::vector<trace::Ray> rays(from.begin(), from.end());
  std::vector<SeenByRay> out(rays.size());
  std::vector<float> left(rays.size(), 1);
  std::vector<size_t> of(rays.size());  // those that rays still look for
  std::iota(of.begin(), of.end(), 0);
  std::vector<trace::Hit> hits(rays.size());
  for (int layer = 0; layer < trace::kMostSurfaces && !rays.empty(); ++layer) {
    hits.resize(rays.size());
    tracer.closest_covers(rays, hits, layer == 0 ? trace::Packets::bundles : trace::Packets::any);
    size_t open = 0;
    for (size_t k = 0; k < hits.size(); ++k) {
      const trace::Hit& hit = hits[k];
      const size_t i = of[k];
      if (!hit.found()) continue;
      if (backs || !trace::is_unseen_back(scene, hit)) {
        const float coverage = scene::passage_at(scene, hit.point()).coverage;
        out[i].radiance += seen_at(hit) * (left[i] * coverage);
        left[i] *= 1 - coverage;
        if (left[i] < kLeastLeft) left[i] = 0;
        if (left[i] == 0) continue;
      }
      trace::go_on_behind(hit, rays[k]);
      rays[open] = rays[k], of[open] = i, ++open;
    }
    rays.resize(open), of.resize(open);
  }
  for (size_t i = 0; i < out.size(); ++i) {
    if (left[i] > 0) out[i].radiance += behind(from[i]) * left[i];
    out[i].covered = 1 - left[i];
  }
  return out;
}

/// Mean over a pixel's samples; summed in double so that equal samples give back their value.
void write_pixel(std::span<const SeenByRay> seen, float* pixel) {
  double r = 0, g = 0, b = 0, covered = 0;
  for (const SeenByRay& s : seen) {
    r += double(s.radiance.x), g += double(s.radiance.y), b += double(s.radiance.z);
    covered += double(s.covered);
  }
  const double count = double(seen.size());
  pixel[0] = float(r / count), pixel[1] = float(g / count), pixel[2] = float(b / count);
  pixel[3] = float(covered / count);
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
  const trace::CameraRays through(camera, params.width, params.height);
  const SeenBehind behind = [&](const trace::Ray& ray) {
    if (params.behind) return params.behind(ray);
    const float most = params.brightest_behind;
    return min(scene::smooth_surroundings_towards(scene, ray.direction), Rgb{most, most, most});
  };
  image::Image picture(params.width, params.height, 4);
  std::vector<uint32_t> pixels(size_t(params.width) * size_t(params.height));
  std::iota(pixels.begin(), pixels.end(), 0);
  const auto draw_pixels = [&](int per_axis) {
    const size_t per_pixel = size_t(per_axis * per_axis);
    parallel_for(pixels.size(), kPixelsAtOnce, [&](size_t begin, size_t end) {
      if (progress.cancelled()) return;
      const std::span some = std::span(pixels).subspan(begin, end - begin);
      const std::vector<SeenByRay> seen = seen_along(
          scene, tracer, rays_of(through, some, per_axis), params.backs, seen_at, behind);
      for (size_t i = 0; i < some.size(); ++i)
        write_pixel(std::span(seen).subspan(i * per_pixel, per_pixel),
                    picture.data.data() + 4 * size_t(some[i]));
      progress.advance(some.size());
    });
  };
  const int n = params.samples_per_axis;
  progress.begin("draw", n > 1 ? 2 * pixels.size() : pixels.size());
  draw_pixels(1);
  // A pixel that has all its rays may differ from a neighbour that seemed to be like it: what is
  // thinner than a pixel is followed from where one ray met it.
  std::vector<bool> taken(pixels.size());
  while (n > 1 && !pixels.empty() && !progress.cancelled()) {
    pixels = take_differing(picture, pixels, taken);
    draw_pixels(n);
  }
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

bool has_void(const scene::Scene& scene) {
  return scene.environment.empty() && !(max_component(scene.background) > 0);
}

image::Image8 on_screen(const scene::Scene& scene, image::Image picture, float exposure,
                        ToneMap curve) {
  if (has_void(scene))
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const float beside = (1 - picture.at(x, y)[3]) / exposure;
        picture.set_rgb(x, y, picture.rgb(x, y) + kGreyOfNothing * beside);
      }
  return tone_map(picture, exposure, curve);
}

}  // namespace luxel::display
