// `luxel probe` by paths from the point, and by rays that end on the lightmaps of a bake.
#include <algorithm>
#include <cmath>
#include <map>

#include "luxel/base/clock.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/command/lit_bake.h"
#include "luxel/pipeline/command/nearest_surface.h"
#include "luxel/pipeline/command/probe.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/scene/origin.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::pipeline {
namespace {

/// The first round has so many independent estimates; every core gets some.
constexpr size_t kStreams = 64;
constexpr int kFirstPaths = 64;  ///< of each in the first round; rounds double
constexpr int kFirstRays = 64;   ///< the same of a bake
/// Rays that look for sources, and those of them that paths follow on.
constexpr uint32_t kLookingRays = 1 << 15, kFollowedRays = 1 << 12;
constexpr int kPathsPerRay = 16;

/// Where light is asked for.
struct Place {
  Vec3 position{}, normal{}, geometric_normal{};
};

/// Squared standard errors of a round's mean: of red, green, blue and luminance.
struct Squares {
  std::array<double, 4> error2{};
  std::array<double, 4> variance{};  ///< of error2, which is an estimate itself; 0: not known
};

std::array<double, 4> squared(Rgb error, float luminance_error) {
  const DVec3 e = to_double(error);
  return {e.x * e.x, e.y * e.y, e.z * e.z, std::pow(double(luminance_error), 2)};
}

/// Rounds of estimates, each weighted by its number of paths or rays.
class Rounds {
 public:
  Rounds(const ProbeSettings& s, Clock::time_point start) : settings_(s), start_(start) {}

  void add(double weight, Rgb mean, const Squares& squares) {
    was_known_ = count_ > 0 && is_known();
    weight_ += weight, sum_ += mean * float(weight);
    for (size_t c = 0; c < 4; ++c) {
      squares_.error2[c] += std::pow(weight, 2) * squares.error2[c];
      squares_.variance[c] += std::pow(weight, 4) * squares.variance[c];
    }
    ++count_;
  }
  Rgb mean() const { return sum_ / float(weight_); }
  /// The standard error of a channel or the luminance, its square by two of its own standard errors
  /// larger than found: light that few paths bring is missed by the mean and by its error at once.
  float error(size_t c) const {
    return float(std::sqrt(squares_.error2[c] + 2 * std::sqrt(squares_.variance[c])) / weight_);
  }
  bool is_known() const {
    return double(error(3)) <= settings_.max_error * double(luminance(mean()));
  }
  /// True: another round is wanted, and the time left is enough for it, twice that of the last.
  /// Light may look sure by chance, and rounds that end then are too sure of it. So one more round,
  /// with most of all paths, must confirm it.
  bool goes_on(double last_round_s) const {
    const double left = settings_.time_budget_s - seconds_since(start_);
    return !(is_known() && was_known_) && count_ < settings_.most_rounds && left > 2 * last_round_s;
  }
  void finish(Probed& out) const {
    out.irradiance = mean(), out.luminance_error = error(3);
    out.standard_error = {error(0), error(1), error(2)};
    out.out_of_time = !is_known();
  }

 private:
  const ProbeSettings& settings_;
  Clock::time_point start_;
  double weight_ = 0;
  Rgb sum_{};
  Squares squares_;
  int count_ = 0;
  bool was_known_ = false;  ///< before the last round
};

/// The place that is meant; what is said of its surface goes to `out`.
Result<Place> find_place(const ProbeSettings& s, const scene::Scene& scene, Probed& out) {
  if (s.in_air) {
    const Vec3 n = normalize(s.normal.value_or(Vec3{0, 1, 0}));
    out.position = s.at, out.normal = n;
    return Place{scene::in_scene(scene, s.at), n, n};
  }
  const NearestSurface nearest = nearest_surface(scene, scene::in_scene(scene, s.at), s.normal);
  const double diagonal_m = double(scene::world_bounds(scene).diagonal());
  if (!(double(nearest.distance_m) <= kFarFromSurfaces * diagonal_m))
    return Failure{far_from_surfaces(s, diagonal_m, double(nearest.distance_m))};
  out.name = name_of(scene, nearest.point.instance);
  out.material = scene::material_at(scene, nearest.point).name;
  out.position = scene::in_world(scene, nearest.position), out.normal = nearest.normal;
  out.distance_m = nearest.distance_m;
  return Place{nearest.start, nearest.normal, nearest.geometric_normal};
}

/// Rays with the density of the cosine that look for what the place sees.
struct Look {
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Rgb> tints;
};

Look look_from(const ProbeSettings& s, const trace::RayTracer& tracer, const Place& place) {
  Look out;
  const Frame frame = frame_around(place.normal);
  for (uint32_t k = 0; k < kLookingRays; ++k) {
    const Vec3 d = frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, hash64(s.seed, 7))));
    // A ray that a bent normal sends below the surface meets nothing.
    const bool above = dot(d, place.geometric_normal) > 0;
    out.rays.push_back({place.position, 0, d, above ? INFINITY : 0.0f});
  }
  out.hits.resize(out.rays.size());
  tracer.closest_hits(out.rays, out.hits);
  out.tints.assign(out.rays.size(), {1, 1, 1});
  if (tracer.has_tints()) tracer.tint(out.rays, out.hits, out.tints);
  return out;
}

bool is_dark_back(const scene::Scene& scene, const trace::Hit& hit) {
  return hit.back_face && !scene::reflects_from_behind(scene::material_at(scene, hit.point()));
}

Rgb emitted_by(const scene::Scene& scene, const trace::Hit& hit) {
  if (hit.back_face && !scene::material_at(scene, hit.point()).double_sided) return {};
  return scene::emission_at(scene, hit.point());
}

/// The sources of a look. `reflected` is rho E at what its first rays meet.
std::vector<ProbedSource> sources_of(const scene::Scene& scene, const Look& look,
                                     std::span<const Rgb> reflected) {
  std::map<std::pair<uint32_t, uint32_t>, ProbedSource> found;
  for (size_t k = 0; k < look.rays.size(); ++k) {
    const trace::Hit& hit = look.hits[k];
    if (!hit.found()) continue;
    const scene::Mesh& mesh = scene.meshes[scene.instances[hit.instance].mesh];
    const uint32_t material = mesh.triangle_material[hit.triangle];
    ProbedSource& source = found[{hit.instance, material}];
    source.form_factor += 1.0 / kLookingRays;
    source.irradiance += look.tints[k] * emitted_by(scene, hit) * (kPi / float(kLookingRays));
    if (k < reflected.size())
      source.irradiance += look.tints[k] * reflected[k] / float(reflected.size());
  }
  std::vector<ProbedSource> out;
  for (auto& [key, source] : found) {
    source.name = name_of(scene, key.first), source.material = scene.materials[key.second].name;
    out.push_back(std::move(source));
  }
  std::stable_sort(out.begin(), out.end(), [](const ProbedSource& a, const ProbedSource& b) {
    return luminance(a.irradiance) > luminance(b.irradiance);
  });
  return out;
}

/// Light that comes from none of the sources; not below 0 where noise would make it so.
void set_rest(Probed& out) {
  Rgb rest = out.irradiance;
  for (const ProbedSource& source : out.sources) rest = rest - source.irradiance;
  out.punctual_and_background = max(Rgb{}, rest);
}

/// rho E at what the first rays of a look meet, by paths.
Result<std::vector<Rgb>> reflected_by_paths(const ProbeSettings& s, const scene::Scene& scene,
                                            const trace::RayTracer& tracer, const Look& look,
                                            Progress& progress) {
  const size_t count = std::min<size_t>(kFollowedRays, look.rays.size());
  std::vector<Rgb> out(count);
  std::vector<size_t> rays;
  std::vector<Vec3> positions, normals, geometric_normals;
  for (size_t k = 0; k < count; ++k) {
    const trace::Hit& hit = look.hits[k];
    if (!hit.found() || is_dark_back(scene, hit)) continue;
    const transport::SmoothPoint at =
        transport::smooth_point(scene, hit.point(), hit.back_face ? -1.0f : 1.0f);
    rays.push_back(k), positions.push_back(at.start);
    normals.push_back(at.normal), geometric_normals.push_back(at.geometric_normal);
  }
  LUXEL_TRY(const reference::TexelPaths paths,
            reference::irradiance_by_paths(scene, {positions, normals, geometric_normals}, tracer,
                                           {kPathsPerRay, -1, hash64(s.seed, 8)}, progress));
  for (size_t i = 0; i < rays.size(); ++i)
    out[rays[i]] = scene::reflectance_at(scene, look.hits[rays[i]].point()) * paths.irradiance[i];
  return out;
}

/// Squared errors of the mean over all receivers of one place: each says how wide its own paths
/// scatter.
Squares squares_of(const reference::TexelPaths& traced) {
  const auto n = double(traced.irradiance.size());
  Squares out;
  for (size_t c = 0; c < 4; ++c) {
    double sum = 0, sum2 = 0;
    for (size_t i = 0; i < traced.irradiance.size(); ++i) {
      const double error2 = squared(traced.standard_error[i], traced.luminance_error[i])[c];
      sum += error2, sum2 += error2 * error2;
    }
    out.error2[c] = sum / (n * n);
    out.variance[c] = std::max(0.0, sum2 - sum * sum / n) * n / (n - 1) / (n * n * n * n);
  }
  return out;
}

/// E of a place by paths, round by round.
Status trace_rounds(const ProbeSettings& s, const scene::Scene& scene,
                    const trace::RayTracer& tracer, const Place& place, Clock::time_point start,
                    Probed& out, Progress& progress) {
  const std::vector<Vec3> positions(kStreams, place.position), normals(kStreams, place.normal);
  const std::vector<Vec3> geometric(kStreams, place.geometric_normal);
  Rounds rounds(s, start);
  double last_s = 0;
  int paths = kFirstPaths;
  for (uint64_t round = 0; round == 0 || rounds.goes_on(last_s); ++round, paths *= 2) {
    const Clock::time_point begun = Clock::now();
    LUXEL_TRY(const reference::TexelPaths traced,
              reference::irradiance_by_paths(scene, {positions, normals, geometric}, tracer,
                                             {paths, -1, hash64(s.seed, round), true}, progress));
    Rgb mean{};
    for (const Rgb& e : traced.irradiance) mean += e;
    rounds.add(paths, mean / float(kStreams), squares_of(traced));
    last_s = seconds_since(begun);
  }
  rounds.finish(out);
  return {};
}

}  // namespace

Result<Probed> probe_by_paths(const ProbeSettings& s, Progress& progress) {
  const Clock::time_point start = Clock::now();
  progress.begin("import", 0);
  Probed out;
  LUXEL_TRY(const scene::Scene scene, read_probe_scene(s, out));
  ProbeSettings rest = s;
  rest.time_budget_s -= seconds_since(start);
  return probe_by_paths(rest, scene, std::move(out), progress);
}

Result<Probed> probe_by_paths(const ProbeSettings& s, const scene::Scene& scene, Probed out,
                              Progress& progress) {
  const Clock::time_point start = Clock::now();
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  LUXEL_TRY(const Place place, find_place(s, scene, out));
  const Look look = look_from(s, tracer, place);
  LUXEL_TRY(const std::vector<Rgb> reflected, reflected_by_paths(s, scene, tracer, look, progress));
  out.sources = sources_of(scene, look, reflected);
  LUXEL_TRY_STATUS(trace_rounds(s, scene, tracer, place, start, out, progress));
  LUXEL_TRY_STATUS(check_held(scene, place.position, out));
  if (!(max_component(out.irradiance) > 0)) out.warnings.push_back(no_light_arrives("the point"));
  set_rest(out);
  return out;
}

Result<Probed> probe_in_bake(const ProbeSettings& s, Progress& progress) {
  const Clock::time_point start = Clock::now();
  progress.begin("import", 0);
  LUXEL_TRY(const std::unique_ptr<LitBake> bake,
            read_lit_bake(s.scene, s.reading, s.from, s.outside));
  Probed out;
  out.warnings = bake->warnings, out.unit = bake->unit;
  LUXEL_TRY(const Place place, find_place(s, bake->baked, out));
  if (!s.in_air) {
    const NearestSurface nearest =
        nearest_surface(bake->baked, scene::in_scene(bake->baked, s.at), s.normal);
    out.interpolated = lightmap_of(*bake, nearest.point);
  }
  const Look look = look_from(s, *bake->baked_tracer, place);
  std::vector<Rgb> reflected(look.rays.size());
  const auto irradiance = [&](const scene::SurfacePoint& p) { return lightmap_of(*bake, p); };
  for (size_t k = 0; k < reflected.size(); ++k)
    if (look.hits[k].found() && !is_dark_back(bake->baked, look.hits[k]))
      reflected[k] = transport::radiosity_at(bake->baked, look.hits[k].point(), irradiance);
  out.sources = sources_of(bake->baked, look, reflected);
  Rounds rounds(s, start);
  double last_s = 0;
  int rays = kFirstRays;
  for (uint64_t round = 0; round == 0 || rounds.goes_on(last_s); ++round, rays *= 2) {
    const Clock::time_point begun = Clock::now();
    LUXEL_TRY(const PlacesLight light,
              light_at_places(*bake, {&place.position, 1}, {&place.normal, 1},
                              {int(kStreams), rays, rays, hash64(s.seed, round)}, progress));
    rounds.add(rays, light.irradiance[0],
               {squared(light.standard_error[0], light.luminance_error[0]), {}});
    last_s = seconds_since(begun);
  }
  rounds.finish(out);
  LUXEL_TRY_STATUS(check_held(bake->scene, place.position, out));
  set_rest(out);
  return out;
}

}  // namespace luxel::pipeline
