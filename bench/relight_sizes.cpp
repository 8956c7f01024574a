// The hierarchy from four thousand patches to sixty-four.
#include "bench/relight.h"
#include "bench/timing.h"
#include "luxel/scene/procedural.h"
#include "luxel/solve/matrix/codec.h"
#include "luxel/solve/matrix/relight.h"
#include "luxel/solve/matrix/trials.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {

const float kSizesBlockError = 0.001f;

namespace {

/// 65,536 patches of so many rays take 4 GB while they are prepared.
constexpr int kRelightSizesRays = 2048, kRelightSizesRounds = 9;
/// Error that unfinished bounces may have: half of the goal.
constexpr double kErrorOfSweeps = 0.005;
/// A converged answer by the factors of 65,536 patches takes seconds.
constexpr int kTrials = 2;

Result<SizeRun> run_size(const scene::Scene& scene, const trace::RayTracer& tracer, size_t count,
                         Progress& progress) {
  // Preparation, timed: factors, compression, coarse scene.
  const size_t first_stage = progress.stages().size();
  LUXEL_TRY(const matrix::Prepared prepared,
            matrix::prepare(
                scene, tracer,
                {.patches = {.count = count}, .factors = {.rays_per_patch = kRelightSizesRays}},
                progress));
  const matrix::Patches& patches = prepared.patched.patches;
  const std::span<const Rgb> rho = patches.elements.reflectance;
  LUXEL_TRY(matrix::Hierarchical hierarchy,
            matrix::compress(
                prepared.factors, prepared.patched.tree, patches.centroid, patches.area_m2,
                {.block_error = kSizesBlockError, .rays_per_patch = kRelightSizesRays}, progress));
  progress.begin("coarse scene", 0);
  matrix::CoarseScene coarse = make_coarse_scene(prepared.factors, prepared.patched.tree,
                                                 patches.area_m2, rho, matrix::kCoarseClusters);
  progress.finish();
  SizeRun run{.patches = patches.size(),
              .rays = kRelightSizesRays,
              .stages = stages_from(progress, first_stage)};
  // Error and time of the codec with as many sweeps as it needs.
  LUXEL_TRY(const matrix::Trials trials,
            make_trials(scene, tracer, prepared, coarse, {.in_the_open = kTrials, .anywhere = 0},
                        progress));
  run.sweeps = enough_sweeps(trials, kErrorOfSweeps);
  const matrix::Codec codec =
      matrix::HierarchicalCodec{std::move(hierarchy), std::move(coarse), run.sweeps};
  run.bytes = bytes_of(codec),
  run.error = usual_error(trials, errors_of(codec, trials, patches, -1));
  matrix::CodecScratch scratch = make_scratch(codec, patches.size());
  std::vector<Rgb> e(patches.size());
  run.ms =
      time_in_turn({[&] {
                     irradiance_of(codec, {trials.sent[0], rho, patches.area_m2, -1}, e, scratch);
                   }},
                   kRelightSizesRounds)[0];
  return run;
}

}  // namespace

Result<std::vector<SizeRun>> run_sizes(Progress& progress) {
  const scene::Scene scene = scene::cornell_box();
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  std::vector<SizeRun> out;
  for (const size_t count : {4096, 8192, 16384, 32768, 65536}) {
    LUXEL_TRY(SizeRun run, run_size(scene, tracer, count, progress));
    out.push_back(std::move(run));
  }
  return out;
}

}  // namespace luxel::bench
