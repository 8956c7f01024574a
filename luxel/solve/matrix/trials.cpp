#include "luxel/solve/matrix/trials.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/live_light.h"
#include "luxel/solve/matrix/many_lights.h"
#include "luxel/solve/matrix/probes.h"

namespace luxel::matrix {
namespace {

/// A place is on the way between two surfaces, from `nearest` of it to 1 - `nearest`: of so many
/// places inside of a room the one with most room around.
struct LampPlaces {
  float nearest = 0;
  int count = 1;
};
/// In the open: what a light close to a surface lights is little but a spot, and the noise of the
/// few rays that went there.
constexpr LampPlaces kInTheOpen{0.3f, 16};
/// Anywhere, but no closer to a surface than a patch is wide.
constexpr LampPlaces kAnywhere{0.1f, 1};
/// Places that are looked at: where half of them are not free, 2^-24 of all lamps find none.
constexpr int kMostPlaces = 24;
constexpr uint32_t kLooks = 64;

/// So many of the rays from a place inside of a room meet something. From outside little light
/// comes back, and what is lost of it says nothing.
constexpr float kInside = 0.6f;

/// Distance to the nearest surface [m], by rays in all directions; 0 outside of rooms.
float room_around(const trace::RayTracer& tracer, Vec3 place) {
  float nearest = INFINITY;
  uint32_t met = 0;
  for (uint32_t k = 0; k < kLooks; ++k) {
    const Vec3 towards = uniform_sphere_sample(sobol_owen_2d(k, 1));
    const trace::Hit hit = tracer.closest_hit({place, 0, towards, INFINITY});
    nearest = std::min(nearest, hit.t), met += hit.found();
  }
  return float(met) >= kInside * kLooks ? nearest : 0;
}

/// A lamp, and the room around it [m]; 0 where no place inside of a room was found.
struct PlacedLamp {
  scene::PunctualLight light;
  float room_m = 0;
};

PlacedLamp lamp_at(const LampScene& s, const LampPlaces& places, uint64_t seed) {
  RandomStream random{seed};
  PlacedLamp lamp{{}, -1};
  for (int k = 0, free = 0; k < kMostPlaces && free < places.count; ++k) {
    const auto i =
        std::min(size_t(random.next() * float(s.position.size())), s.position.size() - 1);
    const Vec3 from = s.position[i];
    const Vec3 towards =
        frame_around(s.normal[i]).to_world(cosine_hemisphere_sample(random.next2()));
    const float hit_m = s.tracer.closest_hit({from, 0, towards, INFINITY}).t;
    const float part = places.nearest + (1 - 2 * places.nearest) * random.next();
    const Vec3 place = from + towards * (std::min(hit_m, s.farthest_m) * part);
    const float room = room_around(s.tracer, place);
    free += room >= s.clearance_m;
    if (room > lamp.room_m) lamp.room_m = room, lamp.light.position = place;
  }
  return lamp;
}

/// Relative square of an error, by area; of `wanted` and what comes straight with it.
double relative_square(std::span<const Rgb> got, std::span<const Rgb> wanted,
                       std::span<const Rgb> straight, std::span<const float> area_m2) {
  double error = 0, all = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    const Rgb d = got[i] - wanted[i], whole = wanted[i] + straight[i];
    error += double(area_m2[i]) * double(dot(d, d));
    all += double(area_m2[i]) * double(dot(whole, whole));
  }
  return all > 0 ? error / all : 0;
}

/// Error of a trial's light, relative root mean square.
double rms_error(const Trials& trials, size_t trial, std::span<const Rgb> got,
                 std::span<const float> area_m2) {
  return std::sqrt(relative_square(got, trials.irradiance[trial], trials.straight[trial], area_m2));
}

/// Sweeps that leave nothing to be seen in single precision, ...
constexpr int kManySweeps = 12;
/// ... or fewer, after one that changed no light by more than this part of it.
constexpr double kConverged = 1e-6;

/// Finds the irradiance of all trials by all bounces, and the errors of fewer sweeps.
Status follow_all_bounces(const Prepared& prepared, const CoarseScene& coarse, Trials& trials,
                          Progress& progress) {
  const Patches& patches = prepared.patched.patches;
  std::vector<ManyLights> after;  // 1, 2, ... sweeps
  const auto see = [&](const ManyLights& now) {
    bool goes_on = after.empty();
    for (size_t t = 0; t < now.size() && !goes_on; ++t)
      goes_on = relative_square(after.back()[t], now[t], trials.straight[t], patches.area_m2) >
                kConverged * kConverged;
    after.push_back(now);
    return goes_on;
  };
  LUXEL_TRY(trials.irradiance,
            all_bounces(prepared.factors, coarse,
                        {trials.sent, patches.elements.reflectance, patches.area_m2}, kManySweeps,
                        see, progress));
  for (const ManyLights& light : after) {
    std::vector<double>& errors = trials.error_of_sweeps.emplace_back();
    for (size_t t = 0; t < light.size(); ++t)
      errors.push_back(rms_error(trials, t, light[t], patches.area_m2));
  }
  return {};
}

/// A lamp that was not tried loses less than the mean of eight others and this many of their
/// standard deviations in 95 of 100 cases, were losses normal: 1.89 sqrt(1 + 1 / 8) = 2.0 by
/// Student's distribution. They have a longer tail: lamps close to a surface.
constexpr double kDeviations = 2.4;

/// A light to try: E per patch of what shines on it unseen by others, and straight from others.
struct Light {
  std::vector<Rgb> direct, straight;
};

/// The prepared scene in which lights are tried, and its probes.
struct Stage {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const Prepared& prepared;
  const Probes probes;

  size_t size() const { return prepared.patched.patches.size(); }
  Light dark() const { return {std::vector<Rgb>(size()), std::vector<Rgb>(size())}; }
};

Light lit_by(const Stage& s, std::span<const scene::PunctualLight> lamps) {
  Light out = s.dark();
  const transport::Elements& at = s.probes.elements;
  std::vector<Rgb> at_probes(at.size());
  live_light({at.position, at.normal, at.normal}, lamps, s.tracer, at_probes);
  out.direct = mean_at_patches(s.probes, at_probes);
  return out;
}

void add_sky(const Stage& s, Rgb background, Light& light) {
  for (size_t i = 0; i < s.size(); ++i) light.straight[i] += background * (kPi * s.prepared.sky[i]);
}

/// So many materials are tried: the first of those that glow, and others at random.
constexpr size_t kMostGlowing = 8, kMostOthers = 4;

std::vector<uint32_t> materials_to_try(std::span<const Rgb> mean,
                                       std::span<const uint32_t> material_of_patch, uint64_t seed) {
  std::vector<uint32_t> glowing, others;
  std::vector<uint8_t> has_patches(mean.size());
  for (const uint32_t m : material_of_patch) has_patches[m] = 1;
  for (uint32_t m = 0; m < mean.size(); ++m)
    if (has_patches[m]) (max_component(mean[m]) > 0 ? glowing : others).push_back(m);
  glowing.resize(std::min(glowing.size(), kMostGlowing));
  RandomStream random{seed};
  for (size_t k = 0; k < std::min(others.size(), kMostOthers); ++k) {
    const auto pick =
        std::min(k + size_t(random.next() * float(others.size() - k)), others.size() - 1);
    std::swap(others[k], others[pick]);
    glowing.push_back(others[k]);
  }
  return glowing;
}

/// The scene's own lights, its background alone, and its materials.
std::vector<Light> own_lights(const Stage& s, const Glow& glow, uint64_t seed) {
  const Patches& patches = s.prepared.patched.patches;
  const std::vector<Rgb> mean = mean_emission_of(patches.emission, patches.material,
                                                 patches.area_m2, s.scene.materials.size());
  std::vector<Light> out{lit_by(s, s.scene.lights)};
  add_sky(s, s.scene.background, out[0]);
  add_glow(glow, mean, out[0].straight);
  out.push_back(s.dark());
  add_sky(s, {1, 1, 1}, out[1]);
  for (const uint32_t m : materials_to_try(mean, patches.material, seed)) {
    std::vector<Rgb> one(mean.size());
    one[m] = {1, 1, 1};
    out.push_back(s.dark());
    add_glow(glow, one, out.back().straight);
  }
  return out;
}

bool is_dark(std::span<const Rgb> light) {
  return std::all_of(light.begin(), light.end(), [](Rgb c) { return max_component(c) <= 0; });
}

}  // namespace

float side_of_patches(std::span<const float> area_m2) {
  double sum = 0;
  for (const float a : area_m2) sum += double(a);
  return float(std::sqrt(sum / double(std::max<size_t>(area_m2.size(), 1))));
}

std::optional<scene::PunctualLight> lamp_at_random(const LampScene& scene, uint64_t seed) {
  const PlacedLamp lamp = lamp_at(scene, kAnywhere, seed);
  if (lamp.room_m <= 0) return {};
  return lamp.light;
}

Result<Trials> make_trials(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const Prepared& prepared, const CoarseScene& coarse,
                           const TrialParams& params, Progress& progress) {
  const Patches& patches = prepared.patched.patches;
  const Stage stage{scene, tracer, prepared, probes_of(patches)};
  const transport::Elements& at = patches.elements;
  const LampScene places{tracer, at.position, at.normal, scene::world_bounds(scene).diagonal(),
                         side_of_patches(patches.area_m2)};
  std::vector<Light> lights;
  for (int k = 0; k < params.in_the_open + params.anywhere; ++k) {
    const PlacedLamp lamp = lamp_at(places, k < params.in_the_open ? kInTheOpen : kAnywhere,
                                    hash64(params.seed, uint64_t(k)));
    lights.push_back(lit_by(stage, {&lamp.light, 1}));
  }
  if (params.glow)
    for (Light& light : own_lights(stage, *params.glow, params.seed))
      lights.push_back(std::move(light));
  // Light that the patches reflect first, trial by trial, and the irradiance that follows from it.
  Trials out;
  for (Light& light : lights) {
    std::vector<Rgb> sent(patches.size());
    for (size_t i = 0; i < sent.size(); ++i)
      sent[i] = patches.elements.reflectance[i] * (light.direct[i] + light.straight[i]);
    if (is_dark(sent)) continue;
    const auto k = int(&light - lights.data());
    if (k < params.in_the_open) ++out.in_the_open;
    if (k >= params.in_the_open && k < params.in_the_open + params.anywhere) ++out.anywhere;
    out.sent.push_back(std::move(sent)), out.straight.push_back(std::move(light.straight));
  }
  progress.begin("trial lights", uint64_t(params.bounces < 0 ? kManySweeps : params.bounces));
  if (params.bounces < 0) {
    LUXEL_TRY_STATUS(follow_all_bounces(prepared, coarse, out, progress));
  } else {
    LUXEL_TRY(out.irradiance,
              count_bounces(prepared.factors, {out.sent, at.reflectance, patches.area_m2},
                            params.bounces, progress));
  }
  return out;
}

int enough_sweeps(const Trials& trials, double error) {
  int sweeps = 2;
  while (size_t(sweeps) <= trials.error_of_sweeps.size() &&
         usual_error(trials, trials.error_of_sweeps[size_t(sweeps) - 1]) > error)
    ++sweeps;
  return sweeps;
}

std::vector<double> errors_of_products(const Prepared& prepared, const Trials& trials,
                                       int products) {
  const Patches& patches = prepared.patched.patches;
  const std::span<const Rgb> rho = patches.elements.reflectance;
  std::vector<double> squares(size_t(products), 0.0);
  std::vector<Rgb> radiosity(patches.size()), irradiance(patches.size());
  for (size_t t = 0; t < trials.sent.size(); ++t) {
    std::fill(irradiance.begin(), irradiance.end(), Rgb{});
    for (double& square : squares) {
      for (size_t i = 0; i < patches.size(); ++i)
        radiosity[i] = trials.sent[t][i] + rho[i] * irradiance[i];
      multiply(prepared.factors, radiosity, irradiance);
      square +=
          relative_square(irradiance, trials.irradiance[t], trials.straight[t], patches.area_m2);
    }
  }
  for (double& square : squares) square = std::sqrt(square / double(trials.sent.size()));
  return squares;
}

namespace {

/// A codec on trial.
class Tried {
 public:
  Tried(const Codec& codec, const Trials& trials, const Patches& patches, int bounces)
      : codec_(codec),
        trials_(trials),
        patches_(patches),
        bounces_(bounces),
        scratch_(make_scratch(codec, patches.size())),
        irradiance_(patches.size()) {}

  double error_of(size_t trial) {
    irradiance_of(codec_,
                  {trials_.sent[trial], patches_.elements.reflectance, patches_.area_m2, bounces_},
                  irradiance_, scratch_);
    return rms_error(trials_, trial, irradiance_, patches_.area_m2);
  }

 private:
  const Codec& codec_;
  const Trials& trials_;
  const Patches& patches_;
  int bounces_ = -1;
  CodecScratch scratch_;
  std::vector<Rgb> irradiance_;
};

}  // namespace

std::vector<double> errors_of(const Codec& codec, const Trials& trials, const Patches& patches,
                              int bounces) {
  Tried tried(codec, trials, patches, bounces);
  std::vector<double> out;
  for (size_t t = 0; t < trials.size(); ++t) out.push_back(tried.error_of(t));
  return out;
}

std::vector<double> errors_until(const Codec& codec, const Trials& trials, const Patches& patches,
                                 int bounces, std::span<const double> before, double most) {
  LUXEL_CHECK(before.size() == trials.size());
  std::vector<size_t> order(trials.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return before[a] > before[b]; });
  Tried tried(codec, trials, patches, bounces);
  std::vector<double> out(trials.size(), 0.0);
  double was2 = 0, is2 = 0;
  for (auto at = order.begin(); at != order.end(); ++at) {
    out[*at] = tried.error_of(*at);
    was2 += before[*at] * before[*at], is2 += out[*at] * out[*at];
    if (usual_error(trials, out) <= most) continue;
    for (++at; at != order.end(); ++at)
      out[*at] = before[*at] * std::sqrt(is2 / std::max(was2, 1e-300));
    break;
  }
  return out;
}

double usual_error(const Trials& trials, std::span<const double> errors) {
  double sum2 = 0, most = 0;
  for (const double e : errors.first(trials.in_the_open)) sum2 += e * e;
  for (const double e : errors.subspan(trials.in_the_open + trials.anywhere))
    most = std::max(most, e);
  return std::max(most, std::sqrt(sum2 / double(std::max<size_t>(trials.in_the_open, 1))));
}

double largest_error(const Trials& trials, std::span<const double> errors) {
  double most = 0, sum = 0, sum2 = 0;
  for (const double e : errors) most = std::max(most, e);
  for (const double e : errors.subspan(trials.in_the_open, trials.anywhere))
    sum += e, sum2 += e * e;
  const auto n = double(trials.anywhere);
  if (n < 2) return most;
  const double variance = std::max(0.0, (sum2 - sum * sum / n) / (n - 1));
  return std::max(most, sum / n + kDeviations * std::sqrt(variance));
}

}  // namespace luxel::matrix
