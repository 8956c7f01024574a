#include "luxel/light/point_error.h"

#include <array>
#include <cmath>

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
/// Shadow rays of an answer over those of the light: then its noise adds little to what is found.
constexpr int kShadowTimes = 4;
/// Any number: it sets these random numbers apart from those of the light.
constexpr uint64_t kPointAnswerSeed = 0x901e7;

/// Radiance that a ray brings.
Rgb radiance_of(const PointCheck& check, const trace::Ray& ray, const trace::Hit& hit) {
  const scene::Scene& scene = check.in.scene;
  if (!hit.found()) return soft_radiance(scene, check.in.lights.around, ray.direction);
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
  check.in.tracer.closest_hits(std::span(rays).first(count), std::span(hits).first(count));
  Rgb sum{};
  for (size_t k = 0; k < count; ++k) sum += radiance_of(check, rays[k], hits[k]);
  return sum * (kPi / kRays);
}

}  // namespace

Result<Answers> point_answers(const PointCheck& check, std::span<const uint8_t> hidden,
                              Progress& progress) {
  const auto is_hidden = [&](size_t i) { return hidden[i] != 0; };
  const uint64_t seed = check.direct.direct.seed;
  const Chances chances = chances_of(check.noise, is_hidden);
  const std::vector<uint32_t> drawn =
      choose_elements(check.noise, is_hidden, chances, kPoints, seed);
  Answers out = answers_for(drawn, check.noise, chances);
  const Chosen chosen = chosen_of(check.in, drawn);
  const TexelScene of_chosen = scene_of(check.in, chosen);
  SupersampleParams direct = check.direct;
  direct.direct.samples *= kShadowTimes;
  progress.begin("check", 2 * chosen.elements.size());
  for (std::vector<Rgb>* answer : {&out.first, &out.second}) {
    direct.direct.seed = hash64(seed, kPointAnswerSeed + (answer == &out.second));
    Progress own;  // its stages are those of the check
    LUXEL_TRY(*answer, direct_anew(of_chosen, direct, own));
    parallel_for(answer->size(), 16, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end && !progress.cancelled(); ++k) {
        (*answer)[k] += by_rays(check, chosen.places, k, hash64(direct.direct.seed, k));
        progress.advance(1);
      }
    });
    LUXEL_TRY_STATUS(stopped(progress));
  }
  return out;
}

double point_error(const Answers& answers, std::span<const Rgb> irradiance) {
  const MeanSquare square = square_error(answers, irradiance);
  return std::sqrt(std::max(0.0, square.mean + 2 * square.standard_error));
}

}  // namespace luxel::light
