#include "solve/matrix/relight.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/warp.h"
#include "solve/matrix/codec.h"
#include "solve/matrix/dense.h"
#include "solve/matrix/live_light.h"

namespace luxel::matrix {
namespace {

/// Places of a patch at which its direct light is taken.
constexpr size_t kProbes = 8;
/// Clusters of the coarse scene, before those are split whose patches see different things. Linear
/// functions over fewer clusters were tried: they do no better for as many numbers.
constexpr size_t kCoarseClusters = 300;

void take_patches(const Patches& patches, RelightData& out) {
  out.position = patches.elements.position, out.normal = patches.elements.normal;
  out.reflectance = patches.elements.reflectance;
  out.area_m2 = patches.area_m2, out.emission = patches.emission, out.material = patches.material;
  for (size_t i = 0; i < patches.size(); ++i) {
    out.first_probe.push_back(uint32_t(out.probe.size()));
    const auto points = patches.points_of(i);
    const size_t count = std::min(points.size(), kProbes);
    for (size_t k = 0; k < count; ++k) out.probe.push_back(points[k * points.size() / count]);
  }
  out.first_probe.push_back(uint32_t(out.probe.size()));
}

/// All triangles in the world. Those whose material has holes block like any other.
Occluders occluders_of(const scene::Scene& scene) {
  Occluders out;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    const auto base = uint32_t(out.position.size());
    for (const Vec3 p : mesh.positions)
      out.position.push_back(transform_point(instance.world_from_object, p));
    for (const auto& t : mesh.triangles)
      out.triangle.push_back({base + t[0], base + t[1], base + t[2]});
  }
  return out;
}

/// Light to try codecs with: lamps in the open, each between a patch and what a ray from there
/// meets first. Of some rays the longest: a lamp in a narrow gap lights little but the gap.
constexpr int kTrials = 8, kRaysPerTrial = 8;

scene::PunctualLight trial_lamp(const trace::RayTracer& tracer, const Patches& patches,
                                float diagonal_m, uint64_t seed) {
  RandomStream random{seed};
  scene::PunctualLight lamp;
  float longest = 0;
  for (int k = 0; k < kRaysPerTrial; ++k) {
    const auto i = std::min(size_t(random.next() * float(patches.size())), patches.size() - 1);
    const Vec3 normal = patches.elements.normal[i];
    const Vec3 from = trace::offset_origin(patches.elements.position[i], normal, diagonal_m);
    const Vec3 towards = frame_around(normal).to_world(cosine_hemisphere_sample(random.next2()));
    const float hit_m = tracer.closest_hit({from, 0, towards, INFINITY}).t;
    const float part = 0.3f + 0.4f * random.next();
    if (!(hit_m < INFINITY) || hit_m <= longest) continue;
    longest = hit_m, lamp.position = from + towards * (hit_m * part);
  }
  return lamp;
}

struct Trials {
  std::vector<std::vector<Rgb>> sent, irradiance;  ///< per trial, per patch
  int sweeps = 2;  ///< after which all bounces are known well enough, if all are wanted
};

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
/// The part of params.max_error that unfinished bounces may have.
constexpr double kPartOfSweeps = 0.6;

/// With the factors themselves.
class Exact {
 public:
  Exact(const Prepared& prepared, const CoarseScene& coarse, int bounces)
      : prepared_(prepared),
        coarse_(coarse),
        bounces_(bounces),
        work_(make_bounce_work(prepared.work.patches.size(), coarse.count())) {}

  std::vector<Rgb> irradiance(std::span<const Rgb> sent, int sweeps) {
    const Patches& patches = prepared_.work.patches;
    const std::vector<Rgb>& rho = patches.elements.reflectance;
    std::vector<Rgb> out(patches.size());
    const Multiply product = [this](auto b, auto e) { multiply(prepared_.factors, b, e); };
    if (bounces_ >= 0)
      count_bounces(product, rho, sent, bounces_, out, work_);
    else
      all_bounces(product, coarse_, rho, patches.area_m2, sent, sweeps, out, work_);
    return out;
  }

 private:
  const Prepared& prepared_;
  const CoarseScene& coarse_;
  int bounces_;
  BounceWork work_;
};

/// The fewest sweeps that keep to their part of the error.
int enough_sweeps(Exact& exact, const Trials& trials, std::span<const float> area_m2,
                  double max_error) {
  for (int sweeps = 2; sweeps < kManySweeps; ++sweeps) {
    double sum = 0;
    for (size_t t = 0; t < trials.sent.size(); ++t)
      sum +=
          relative_square(exact.irradiance(trials.sent[t], sweeps), trials.irradiance[t], area_m2);
    if (std::sqrt(sum / double(trials.sent.size())) <= kPartOfSweeps * max_error) return sweeps;
  }
  return kManySweeps;
}

Result<Trials> make_trials(const scene::Scene& scene, const trace::RayTracer& tracer,
                           const Prepared& prepared, const CoarseScene& coarse,
                           const RelightParams& params, Progress& progress) {
  const Patches& patches = prepared.work.patches;
  const transport::Elements& at = patches.elements;
  const Box3 bounds = scene::world_bounds(scene);
  const float diagonal_m = length(bounds.upper - bounds.lower);
  Exact exact(prepared, coarse, params.bounces);
  Trials out;
  progress.begin("trial lights", kTrials);
  for (uint64_t trial = 0; trial < kTrials; ++trial) {
    const scene::PunctualLight lamp =
        trial_lamp(tracer, patches, diagonal_m, hash64(params.patches.seed, trial));
    std::vector<Rgb> sent(patches.size());
    live_light({at.position, at.normal, at.normal}, {&lamp, 1}, tracer, diagonal_m, sent);
    for (size_t i = 0; i < sent.size(); ++i) sent[i] = at.reflectance[i] * sent[i];
    out.irradiance.push_back(exact.irradiance(sent, kManySweeps));
    out.sent.push_back(std::move(sent));
    if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
    progress.advance(1);
  }
  if (params.bounces < 0)
    out.sweeps = enough_sweeps(exact, out, patches.area_m2, double(params.max_error));
  return out;
}

/// Relative root mean square over all trials and patches, by area; every trial counts alike.
double error_of(const Codec& codec, const Trials& trials, const Patches& patches, int bounces) {
  CodecWork work = make_work(codec, patches.size());
  std::vector<Rgb> irradiance(patches.size());
  double sum = 0;
  for (size_t t = 0; t < trials.sent.size(); ++t) {
    irradiance_of(codec, {trials.sent[t], patches.elements.reflectance, patches.area_m2, bounces},
                  irradiance, work);
    sum += relative_square(irradiance, trials.irradiance[t], patches.area_m2);
  }
  return std::sqrt(sum / double(trials.sent.size()));
}

/// What codecs are made of.
struct Transport {
  const Prepared& prepared;
  const CoarseScene& coarse;
  const Trials& trials;
  const RelightParams& params;
};

/// The coarsest hierarchy that keeps to params.max_error, as far as can be.
Result<Codec> hierarchical_codec(const Transport& t, Progress& progress) {
  const Patches& patches = t.prepared.work.patches;
  HierarchicalParams tried;
  tried.rays_per_patch = t.params.factors.rays_per_patch;
  // What is lost is about in proportion to what blocks may lose: five steps from the first guess
  // span more than a factor of ten.
  tried.block_error = 0.1f * t.params.max_error;
  for (int step = 0;; ++step) {
    LUXEL_TRY(Hierarchical matrix, compress(t.prepared.factors, t.prepared.work.tree,
                                            patches.centroid, patches.area_m2, tried, progress));
    Codec codec = HierarchicalCodec{std::move(matrix), t.coarse, t.trials.sweeps};
    const double error = error_of(codec, t.trials, patches, t.params.bounces);
    if (error <= double(t.params.max_error) || step == 5) return codec;
    tried.block_error *= std::clamp(0.9f * t.params.max_error / float(error), 0.3f, 0.8f);
  }
}

Result<Codec> bc1_codec(const Transport& t, Progress& progress) {
  const Patches& patches = t.prepared.work.patches;
  const int bounces = t.params.bounces == 0 ? 1 : t.params.bounces;
  LUXEL_TRY(const ColourMatrix all,
            make_reflections(t.prepared.factors, patches.elements.reflectance, patches.area_m2,
                             bounces, progress));
  LUXEL_TRY(Bc1 matrix, make_bc1(all, {}, progress));
  return Bc1Codec{std::move(matrix)};
}

/// The most eigenvectors: the small matrices of so many take as long as the large ones.
constexpr uint32_t kMostRank = 768;

/// The fewest eigenvectors, up to a factor of two, that keep to params.max_error, as far as can be.
Result<Codec> low_rank_codec(const Transport& t, Progress& progress) {
  const Patches& patches = t.prepared.work.patches;
  SpectrumParams wanted;
  wanted.count = uint32_t(std::min<size_t>(kMostRank, patches.size()));
  wanted.seed = t.params.patches.seed;
  LUXEL_TRY(const Spectrum spectrum,
            spectrum_of(t.prepared.factors, patches.area_m2, wanted, progress));
  for (size_t rank = 48;; rank *= 2) {
    rank = std::min(rank, spectrum.count());
    LUXEL_TRY(LowRank matrix, make_low_rank(spectrum, rank, patches.area_m2,
                                            patches.elements.reflectance, progress));
    Codec codec = LowRankCodec{std::move(matrix)};
    const double error = error_of(codec, t.trials, patches, t.params.bounces);
    if (error <= double(t.params.max_error) || rank == spectrum.count()) return codec;
  }
}

Result<Codec> codec_of(const Transport& t, Progress& progress) {
  const size_t patches = t.prepared.work.patches.size();
  const CodecKind kind = t.params.codec;
  if (kind != CodecKind::hierarchical && kind != CodecKind::lowrank && patches > kMaxDensePatches)
    return fail(ErrorCode::bad_setting,
                "{} patches are too many for a codec that looks at all pairs, which takes {} at "
                "most; ask for fewer, or for the hierarchical codec",
                patches, kMaxDensePatches);
  progress.begin("codec", 0);
  if (kind == CodecKind::hierarchical) return hierarchical_codec(t, progress);
  if (kind == CodecKind::lowrank) return low_rank_codec(t, progress);
  if (kind == CodecKind::bc1) return bc1_codec(t, progress);
  const Precision precision = kind == CodecKind::dense32 ? Precision::single : Precision::half;
  return DenseCodec{make_dense(t.prepared.factors, precision), t.coarse, t.trials.sweeps};
}

}  // namespace

Result<RelightData> make_relight_data(const scene::Scene& scene, const trace::RayTracer& tracer,
                                      Target target, const RelightParams& params,
                                      Progress& progress) {
  LUXEL_TRY(const Prepared prepared,
            prepare(scene, tracer, {params.patches, params.factors}, progress));
  const Patches& patches = prepared.work.patches;
  RelightData out;
  take_patches(patches, out);
  out.sky = prepared.sky, out.bounces = params.bounces;
  out.lights = scene.lights, out.background = scene.background;
  for (const scene::Material& m : scene.materials) out.material_name.push_back(m.name);
  progress.begin("coarse scene", 0);
  const CoarseScene coarse =
      make_coarse_scene(prepared.factors, prepared.work.tree, patches.area_m2,
                        patches.elements.reflectance, kCoarseClusters);
  LUXEL_TRY(const Trials trials, make_trials(scene, tracer, prepared, coarse, params, progress));
  LUXEL_TRY(out.codec, codec_of({prepared, coarse, trials, params}, progress));
  out.codec_error = error_of(out.codec, trials, patches, params.bounces);
  LUXEL_TRY(target.transfer, make_transfer(prepared.work, tracer,
                                           {target.position, target.geometric_normal}, progress));
  out.target = std::move(target);
  out.occluders = occluders_of(scene);
  return out;
}

}  // namespace luxel::matrix
