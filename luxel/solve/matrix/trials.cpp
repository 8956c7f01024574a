#include "luxel/solve/matrix/trials.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/live_light.h"

namespace luxel::matrix {
namespace {

/// A trial's light stands where, of so many places, there is most room around: what a light close
/// to a surface lights is little but a spot, and the noise of the few rays that went there. With so
/// many, one is outside of closed solids, where in furnished rooms half of all patches are: 2^-16
/// fail.
constexpr int kPlacesPerTrial = 16;
constexpr uint32_t kLooks = 64;
/// A place is on the way between two surfaces, from 0.3 to 0.7 of it: near neither.
constexpr float kNearest = 0.3f, kSpan = 0.4f;

/// So many of the rays from a place inside of a room meet something. From outside little light
/// comes back, and what is lost of it says nothing.
constexpr float kInside = 0.6f;

/// How far the nearest surface is, by rays in all directions; outside of rooms a thousandth of
/// that.
float room_around(const trace::RayTracer& tracer, Vec3 place) {
  float nearest = INFINITY;
  uint32_t met = 0;
  for (uint32_t k = 0; k < kLooks; ++k) {
    const Vec3 towards = uniform_sphere_sample(sobol_owen_2d(k, 1));
    const trace::Hit hit = tracer.closest_hit({place, 0, towards, INFINITY});
    nearest = std::min(nearest, hit.t), met += hit.found();
  }
  return float(met) >= kInside * kLooks ? nearest : nearest * 1e-3f;
}

scene::PunctualLight trial_light(const trace::RayTracer& tracer, const Patches& patches,
                                 float diagonal_m, uint64_t seed) {
  RandomStream random{seed};
  scene::PunctualLight light;
  float most = 0;
  for (int k = 0; k < kPlacesPerTrial; ++k) {
    const auto i = std::min(size_t(random.next() * float(patches.size())), patches.size() - 1);
    const Vec3 normal = patches.elements.normal[i];
    const Vec3 from = trace::offset_origin(patches.elements.position[i], normal, diagonal_m);
    const Vec3 towards = frame_around(normal).to_world(cosine_hemisphere_sample(random.next2()));
    const float hit_m = tracer.closest_hit({from, 0, towards, INFINITY}).t;
    const Vec3 place =
        from + towards * (std::min(hit_m, diagonal_m) * (kNearest + kSpan * random.next()));
    if (const float room = room_around(tracer, place); room > most && room < INFINITY)
      most = room, light.position = place;
  }
  return light;
}

/// Relative square of an error, by area.
double relative_square(std::span<const Rgb> got, std::span<const Rgb> wanted,
                       std::span<const float> area_m2) {
  double error = 0, all = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    const Rgb d = got[i] - wanted[i];
    error += double(area_m2[i]) * double(dot(d, d));
    all += double(area_m2[i]) * double(dot(wanted[i], wanted[i]));
  }
  return all > 0 ? error / all : 0;
}

/// Sweeps that leave nothing to be seen in single precision.
constexpr int kManySweeps = 12;

/// With the factors themselves.
class Exact {
 public:
  Exact(const Prepared& prepared, size_t clusters)
      : prepared_(prepared),
        scratch_(make_bounce_scratch(prepared.patched.patches.size(), clusters)) {}

  std::vector<Rgb> counted(std::span<const Rgb> sent, int bounces) {
    std::vector<Rgb> out(sent.size());
    count_bounces(product_, sent_by(sent, bounces), out, scratch_);
    return out;
  }
  std::vector<Rgb> all(const CoarseScene& coarse, std::span<const Rgb> sent, int sweeps) {
    std::vector<Rgb> out(sent.size());
    all_bounces(product_, coarse, sent_by(sent, -1), sweeps, out, scratch_);
    return out;
  }

 private:
  Sent sent_by(std::span<const Rgb> radiosity, int bounces) const {
    const Patches& patches = prepared_.patched.patches;
    return {radiosity, patches.elements.reflectance, patches.area_m2, bounces};
  }

  const Prepared& prepared_;
  const Multiply product_ = [this](auto b, auto e) { multiply(prepared_.factors, b, e); };
  BounceScratch scratch_;
};

/// Root mean square over the trials of what `solve(sent)` errs by.
template <class Solve>
double rms_error(const Trials& trials, std::span<const float> area_m2, const Solve& solve) {
  double sum = 0;
  for (size_t t = 0; t < trials.sent.size(); ++t)
    sum += relative_square(solve(trials.sent[t]), trials.irradiance[t], area_m2);
  return std::sqrt(sum / double(trials.sent.size()));
}

}  // namespace

Result<Trials> make_trials(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const Prepared& prepared, const CoarseScene& coarse,
                           const TrialParams& params, Progress& progress) {
  const Patches& patches = prepared.patched.patches;
  const transport::Elements& at = patches.elements;
  const Box3 bounds = scene::world_bounds(scene);
  const float diagonal_m = length(bounds.upper - bounds.lower);
  Exact exact(prepared, coarse.count());
  Trials out;
  progress.begin("trial lights", uint64_t(params.count));
  for (int trial = 0; trial < params.count; ++trial) {
    // What patches reflect of a light at first.
    const scene::PunctualLight light =
        trial_light(tracer, patches, diagonal_m, hash64(params.seed, uint64_t(trial)));
    std::vector<Rgb> sent(patches.size());
    live_light({at.position, at.normal, at.normal}, {&light, 1}, tracer, diagonal_m, sent);
    for (size_t i = 0; i < sent.size(); ++i) sent[i] = at.reflectance[i] * sent[i];
    // What all of them get of that.
    out.irradiance.push_back(params.bounces < 0 ? exact.all(coarse, sent, kManySweeps)
                                                : exact.counted(sent, params.bounces));
    out.sent.push_back(std::move(sent));
    LUXEL_TRY_STATUS(stopped(progress));
    progress.advance(1);
  }
  return out;
}

int enough_sweeps(const Prepared& prepared, const CoarseScene& coarse, const Trials& trials,
                  double error) {
  Exact exact(prepared, coarse.count());
  for (int sweeps = 2; sweeps < kManySweeps; ++sweeps) {
    const auto solve = [&](std::span<const Rgb> sent) { return exact.all(coarse, sent, sweeps); };
    if (rms_error(trials, prepared.patched.patches.area_m2, solve) <= error) return sweeps;
  }
  return kManySweeps;
}

std::vector<double> errors_of_products(const Prepared& prepared, const Trials& trials,
                                       int products) {
  const Patches& patches = prepared.patched.patches;
  const std::vector<Rgb>& rho = patches.elements.reflectance;
  std::vector<double> squares(size_t(products), 0.0);
  std::vector<Rgb> radiosity(patches.size()), irradiance(patches.size());
  for (size_t t = 0; t < trials.sent.size(); ++t) {
    std::fill(irradiance.begin(), irradiance.end(), Rgb{});
    for (double& square : squares) {
      for (size_t i = 0; i < patches.size(); ++i)
        radiosity[i] = trials.sent[t][i] + rho[i] * irradiance[i];
      multiply(prepared.factors, radiosity, irradiance);
      square += relative_square(irradiance, trials.irradiance[t], patches.area_m2);
    }
  }
  for (double& square : squares) square = std::sqrt(square / double(trials.sent.size()));
  return squares;
}

double error_of(const Codec& codec, const Trials& trials, const Patches& patches, int bounces) {
  CodecScratch scratch = make_scratch(codec, patches.size());
  std::vector<Rgb> irradiance(patches.size());
  return rms_error(trials, patches.area_m2, [&](std::span<const Rgb> sent) {
    irradiance_of(codec, {sent, patches.elements.reflectance, patches.area_m2, bounces}, irradiance,
                  scratch);
    return std::span<const Rgb>(irradiance);
  });
}

}  // namespace luxel::matrix
