#include "solve/matrix/relight.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "solve/matrix/codec.h"
#include "solve/matrix/dense.h"

namespace luxel::matrix {
namespace {

/// Places of a patch at which its direct light is taken.
constexpr size_t kProbes = 8;
/// Clusters of the coarse scene: two sweeps err by less than codecs do. Linear functions over fewer
/// clusters were tried: they do no better for as many numbers.
constexpr size_t kCoarseClusters = 512;

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

/// Light to try codecs with: what some patches, each shining alone, send to all others, and those
/// reflect. It has the shadows that the scene has.
constexpr int kTrials = 8;

struct Trials {
  std::vector<std::vector<Rgb>> sent, irradiance;  ///< per trial, per patch
};

Result<Trials> make_trials(const FormFactors& factors, const CoarseScene& coarse,
                           const Patches& patches, const RelightParams& params,
                           Progress& progress) {
  const Multiply exact = [&](auto b, auto e) { multiply(factors, b, e); };
  BounceWork work = make_bounce_work(patches.size(), coarse.count());
  const std::vector<Rgb>& rho = patches.elements.reflectance;
  Trials out;
  progress.begin("trial lights", kTrials);
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto lamp = uint32_t(hash64(params.patches.seed, uint64_t(trial)) % patches.size());
    std::vector<Rgb> sent(patches.size()), irradiance(patches.size());
    for (uint64_t k = factors.first[lamp]; k < factors.first[lamp + 1]; ++k) {
      const uint32_t j = factors.column[k];
      sent[j] = rho[j] * (factors.factor[k] / patches.area_m2[j]);
    }
    if (params.bounces >= 0)
      count_bounces(exact, rho, sent, params.bounces, irradiance, work);
    else
      all_bounces(exact, coarse, rho, patches.area_m2, sent, 5, irradiance, work);
    if (progress.cancelled()) return fail(ErrorCode::cancelled, "cancelled");
    out.sent.push_back(std::move(sent)), out.irradiance.push_back(std::move(irradiance));
    progress.advance(1);
  }
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
    double error = 0, all = 0;
    for (size_t i = 0; i < irradiance.size(); ++i) {
      const Rgb d = irradiance[i] - trials.irradiance[t][i], e = trials.irradiance[t][i];
      error += double(patches.area_m2[i]) * double(dot(d, d));
      all += double(patches.area_m2[i]) * double(dot(e, e));
    }
    sum += all > 0 ? error / all : 0;
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
    Codec codec = HierarchicalCodec{std::move(matrix), t.coarse};
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

Result<Codec> codec_of(const Transport& t, Progress& progress) {
  const size_t patches = t.prepared.work.patches.size();
  const CodecKind kind = t.params.codec;
  if (kind != CodecKind::hierarchical && patches > kMaxDensePatches)
    return fail(ErrorCode::bad_setting,
                "{} patches are too many for a codec that looks at all pairs, which takes {} at "
                "most; ask for fewer, or for the hierarchical codec",
                patches, kMaxDensePatches);
  progress.begin("codec", 0);
  if (kind == CodecKind::hierarchical) return hierarchical_codec(t, progress);
  if (kind == CodecKind::bc1) return bc1_codec(t, progress);
  const Precision precision = kind == CodecKind::dense32 ? Precision::single : Precision::half;
  return DenseCodec{make_dense(t.prepared.factors, precision), t.coarse};
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
  LUXEL_TRY(const Trials trials, make_trials(prepared.factors, coarse, patches, params, progress));
  LUXEL_TRY(out.codec, codec_of({prepared, coarse, trials, params}, progress));
  out.codec_error = error_of(out.codec, trials, patches, params.bounces);
  LUXEL_TRY(target.transfer, make_transfer(prepared.work, tracer,
                                           {target.position, target.geometric_normal}, progress));
  out.target = std::move(target);
  out.occluders = occluders_of(scene);
  return out;
}

}  // namespace luxel::matrix
