#include "luxel/solve/matrix/make_codec.h"

#include <algorithm>
#include <cmath>

namespace luxel::matrix {
namespace {

/// The part of params.max_error that unfinished bounces may have. Errors of bounces and of blocks
/// do not depend on each other, so that their squares add up: 0.6^2 + 0.8^2 = 1 leaves 0.8 of it to
/// the blocks. A smaller part costs sweeps, and time; a larger one costs blocks, and memory.
constexpr double kPartOfSweeps = 0.6;
/// The first block_error that is tried, as a part of params.max_error. A row passes through many
/// blocks, whose errors add up.
constexpr float kFirstBlockError = 0.1f;
/// Errors are about in proportion to block_error. The next one aims at this part of max_error, so
/// that the step does not end just above it, ...
constexpr float kAim = 0.9f;
/// ... and is smaller by these factors: no less, because steps would get nowhere, and no more,
/// because proportion holds nearby only, and a block_error that is too small costs memory.
constexpr float kMostShrunk = 0.3f, kLeastShrunk = 0.8f;
/// Steps from the first block_error; 0.8^8 = 0.17 and 0.3^8 = 7e-5 of it.
constexpr int kMaxSteps = 8;

/// Smaller blocks, towards max_error. What blocks may lose of the noise of rays is a floor under
/// the error: where a step got less than half the way that it was to go (in logarithms), that
/// shrinks, too. `error` and `before` are those of the last two steps, `factor` lies between them;
/// returned is that to the next.
float shrink(HierarchicalParams& tried, double max_error, double error, double before,
             float factor) {
  const bool stuck = error > before * double(std::sqrt(factor));
  factor = std::clamp(kAim * float(max_error / error), kMostShrunk, kLeastShrunk);
  tried.block_error *= factor;
  if (stuck) tried.noise *= factor * factor;
  return factor;
}

/// The sweeps of all_bounces: as many as keep to their part of the error. Counted bounces take
/// none, and 2 stands in the file.
int sweeps_of(const CodecInput& t, const RelightParams& params) {
  if (params.bounces >= 0) return 2;
  return enough_sweeps(t.trials, kPartOfSweeps * double(params.max_error));
}

MadeCodec tried_codec(const CodecInput& t, const RelightParams& params, Codec codec) {
  std::vector<double> errors =
      errors_of(codec, t.trials, t.prepared.patched.patches, params.bounces);
  return {std::move(codec), std::move(errors)};
}

/// The coarsest hierarchy that keeps to params.max_error, as far as can be.
Result<MadeCodec> hierarchical_codec(const CodecInput& t, const RelightParams& params,
                                     Progress& progress) {
  const Patches& patches = t.prepared.patched.patches;
  const int sweeps = sweeps_of(t, params);
  HierarchicalParams tried;
  tried.rays_per_patch = params.factors.rays_per_patch;
  tried.block_error = kFirstBlockError * params.max_error;
  Compression compression(t.prepared.factors, t.prepared.patched.tree, patches.centroid,
                          patches.area_m2, tried.rays_per_patch);
  std::vector<double> errors;
  double before = INFINITY;
  float factor = 1;
  for (int step = 0;; ++step) {
    LUXEL_TRY(Hierarchical matrix, compression.step(tried, progress));
    Codec codec = HierarchicalCodec{std::move(matrix), t.coarse, sweeps};
    const bool all = step == 0 || step == kMaxSteps;
    errors = all ? errors_of(codec, t.trials, patches, params.bounces)
                 : errors_until(codec, t.trials, patches, params.bounces, errors,
                                double(params.max_error));
    const double error = usual_error(t.trials, errors);
    if (error <= double(params.max_error) || step == kMaxSteps)
      return MadeCodec{std::move(codec), std::move(errors)};
    factor = shrink(tried, double(params.max_error), error, before, factor);
    before = error;
  }
}

Result<MadeCodec> bc1_codec(const CodecInput& t, const RelightParams& params, Progress& progress) {
  const Patches& patches = t.prepared.patched.patches;
  const int bounces = params.bounces == 0 ? 1 : params.bounces;
  LUXEL_TRY(const ColourMatrix all,
            make_reflections(t.prepared.factors, patches.elements.reflectance, patches.area_m2,
                             bounces, progress));
  LUXEL_TRY(Bc1 matrix, make_bc1(all, {}, progress));
  return tried_codec(t, params, Bc1Codec{std::move(matrix)});
}

/// The most eigenvectors: the small matrices of so many take as long as the large ones.
constexpr uint32_t kMostRank = 768;
/// The fewest that are tried: with 48 the Cornell box errs by 19 % (docs/method/relight.md).
constexpr size_t kFirstRank = 48;

/// The fewest eigenvectors, up to a factor of two, that keep to params.max_error, as far as can be.
Result<MadeCodec> low_rank_codec(const CodecInput& t, const RelightParams& params,
                                 Progress& progress) {
  const Patches& patches = t.prepared.patched.patches;
  SpectrumParams wanted;
  wanted.count = uint32_t(std::min<size_t>(kMostRank, patches.size()));
  wanted.seed = params.patches.seed;
  LUXEL_TRY(const Spectrum spectrum,
            spectrum_of(t.prepared.factors, patches.area_m2, wanted, progress));
  for (size_t rank = kFirstRank;; rank *= 2) {
    rank = std::min(rank, spectrum.count());
    LUXEL_TRY(LowRank matrix, make_low_rank(spectrum, rank, patches.area_m2,
                                            patches.elements.reflectance, progress));
    MadeCodec made = tried_codec(t, params, LowRankCodec{std::move(matrix)});
    const double error = usual_error(t.trials, made.errors);
    if (error <= double(params.max_error) || rank == spectrum.count()) return made;
  }
}

}  // namespace

Result<MadeCodec> make_codec(const CodecInput& t, const RelightParams& params, Progress& progress) {
  const size_t patches = t.prepared.patched.patches.size();
  const CodecKind kind = params.codec;
  if (looks_at_all_pairs(kind) && patches > kMaxDensePatches)
    return fail(ErrorCode::bad_setting,
                "{} patches are too many for a codec that handles all pairs, which takes {} at "
                "most; ask for fewer, or for the hierarchical codec",
                patches, kMaxDensePatches);
  progress.begin("codec", 0);
  if (kind == CodecKind::hierarchical) return hierarchical_codec(t, params, progress);
  if (kind == CodecKind::lowrank) return low_rank_codec(t, params, progress);
  if (kind == CodecKind::bc1) return bc1_codec(t, params, progress);
  const Precision precision = kind == CodecKind::dense32 ? Precision::single : Precision::half;
  return tried_codec(
      t, params,
      DenseCodec{make_dense(t.prepared.factors, precision), t.coarse, sweeps_of(t, params)});
}

}  // namespace luxel::matrix
