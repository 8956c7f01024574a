#include "luxel/light/point_error.h"

#include <array>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"

namespace luxel::light {
namespace {

/// Points that are checked: the error is known to about 1 / sqrt(2 x 500) = 3 % of itself where it
/// is the same everywhere.
constexpr size_t kPoints = 500;
/// Rays per point and answer. Light that varies by its own size is known to 1 / sqrt(1024) = 3 %
/// or, by stratified rays, far better.
constexpr size_t kRays = 1024;

/// What a ray brings.
Rgb radiance_of(const PointCheck& check, const trace::Ray& ray, const trace::Hit& hit) {
  const scene::Scene& scene = check.scene;
  if (!hit.found()) return soft_radiance(scene, check.around, ray.direction);
  if (hit.back_face && !scene::reflects_from_behind(scene::material_at(scene, hit.point())))
    return {};
  return check.radiosity(hit) / kPi;
}

/// E by rays [W/m^2].
Rgb by_rays(const PointCheck& check, const transport::Elements& points, size_t i, uint64_t seed) {
  std::array<trace::Ray, kRays> rays;
  std::array<trace::Hit, kRays> hits;
  const Vec3 from = points.position[i];
  const Frame frame = frame_around(points.normal[i]);
  size_t count = 0;
  for (uint32_t k = 0; k < kRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, seed)));
    if (dot(d, points.geometric_normal[i]) > 0) rays[count++] = {from, 0, d, INFINITY};
  }
  check.tracer.closest_hits(std::span(rays).first(count), std::span(hits).first(count));
  Rgb sum{};
  for (size_t k = 0; k < count; ++k) sum += radiance_of(check, rays[k], hits[k]);
  return sum * (kPi / kRays);
}

}  // namespace

std::vector<uint32_t> points_to_check(size_t count, std::span<const uint8_t> hidden) {
  std::vector<uint32_t> out;
  const size_t step = std::max<size_t>(1, count / kPoints);
  for (size_t i = step / 2; i < count; i += step)
    if (!hidden[i]) out.push_back(uint32_t(i));
  return out;
}

Result<double> point_error(const PointCheck& check, const transport::Elements& points,
                           std::span<const Rgb> gathered, std::span<const uint8_t> hidden,
                           Progress& progress) {
  LUXEL_CHECK(gathered.size() == points.size() && hidden.size() == points.size());
  const std::vector<uint32_t> chosen = points_to_check(points.size(), hidden);
  // The product of both differences at each.
  std::vector<double> square(chosen.size());
  progress.begin("check", chosen.size());
  parallel_for(chosen.size(), 16, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
      const size_t i = chosen[k];
      const auto difference = [&](uint64_t answer) {
        return double(
            luminance(gathered[i] - by_rays(check, points, i, hash64(check.seed, 2 * i + answer))));
      };
      square[k] = difference(0) * difference(1);
      progress.advance(1);
    }
  });
  LUXEL_TRY_STATUS(stopped(progress));
  // Their mean, and two standard errors of that.
  if (chosen.empty()) return 0.0;
  double sum = 0, sum2 = 0;
  for (const double s : square) sum += s, sum2 += s * s;
  const auto n = double(square.size());
  const double mean = sum / n, variance = std::max(0.0, sum2 / n - mean * mean);
  return std::sqrt(std::max(0.0, mean + 2 * std::sqrt(variance / n)));
}

}  // namespace luxel::light
