#include "luxel/solve/matrix/make_codec.h"

#include <algorithm>

namespace luxel::matrix {
namespace {

/// The part of params.max_error that unfinished bounces may have.
constexpr double kPartOfSweeps = 0.6;

/// Of all_bounces.
int sweeps_of(const CodecInput& t, const RelightParams& params) {
  if (params.bounces >= 0) return 2;
  return enough_sweeps(t.prepared, t.coarse, t.trials, kPartOfSweeps * double(params.max_error));
}

/// The coarsest hierarchy that keeps to params.max_error, as far as can be.
Result<Codec> hierarchical_codec(const CodecInput& t, const RelightParams& params,
                                 Progress& progress) {
  const Patches& patches = t.prepared.work.patches;
  const int sweeps = sweeps_of(t, params);
  HierarchicalParams tried;
  tried.rays_per_patch = params.factors.rays_per_patch;
  // What is lost is about in proportion to what blocks may lose: five steps from the first guess
  // span more than a factor of ten.
  tried.block_error = 0.1f * params.max_error;
  for (int step = 0;; ++step) {
    LUXEL_TRY(Hierarchical matrix, compress(t.prepared.factors, t.prepared.work.tree,
                                            patches.centroid, patches.area_m2, tried, progress));
    Codec codec = HierarchicalCodec{std::move(matrix), t.coarse, sweeps};
    const double error = error_of(codec, t.trials, patches, params.bounces);
    if (error <= double(params.max_error) || step == 5) return codec;
    tried.block_error *= std::clamp(0.9f * params.max_error / float(error), 0.3f, 0.8f);
  }
}

Result<Codec> bc1_codec(const CodecInput& t, const RelightParams& params, Progress& progress) {
  const Patches& patches = t.prepared.work.patches;
  const int bounces = params.bounces == 0 ? 1 : params.bounces;
  LUXEL_TRY(const ColourMatrix all,
            make_reflections(t.prepared.factors, patches.elements.reflectance, patches.area_m2,
                             bounces, progress));
  LUXEL_TRY(Bc1 matrix, make_bc1(all, {}, progress));
  return Bc1Codec{std::move(matrix)};
}

/// The most eigenvectors: the small matrices of so many take as long as the large ones.
constexpr uint32_t kMostRank = 768;

/// The fewest eigenvectors, up to a factor of two, that keep to params.max_error, as far as can be.
Result<Codec> low_rank_codec(const CodecInput& t, const RelightParams& params, Progress& progress) {
  const Patches& patches = t.prepared.work.patches;
  SpectrumParams wanted;
  wanted.count = uint32_t(std::min<size_t>(kMostRank, patches.size()));
  wanted.seed = params.patches.seed;
  LUXEL_TRY(const Spectrum spectrum,
            spectrum_of(t.prepared.factors, patches.area_m2, wanted, progress));
  for (size_t rank = 48;; rank *= 2) {
    rank = std::min(rank, spectrum.count());
    LUXEL_TRY(LowRank matrix, make_low_rank(spectrum, rank, patches.area_m2,
                                            patches.elements.reflectance, progress));
    Codec codec = LowRankCodec{std::move(matrix)};
    const double error = error_of(codec, t.trials, patches, params.bounces);
    if (error <= double(params.max_error) || rank == spectrum.count()) return codec;
  }
}

}  // namespace

Result<Codec> make_codec(const CodecInput& t, const RelightParams& params, Progress& progress) {
  const size_t patches = t.prepared.work.patches.size();
  const CodecKind kind = params.codec;
  if (looks_at_all_pairs(kind) && patches > kMaxDensePatches)
    return fail(ErrorCode::bad_setting,
                "{} patches are too many for a codec that looks at all pairs, which takes {} at "
                "most; ask for fewer, or for the hierarchical codec",
                patches, kMaxDensePatches);
  progress.begin("codec", 0);
  if (kind == CodecKind::hierarchical) return hierarchical_codec(t, params, progress);
  if (kind == CodecKind::lowrank) return low_rank_codec(t, params, progress);
  if (kind == CodecKind::bc1) return bc1_codec(t, params, progress);
  const Precision precision = kind == CodecKind::dense32 ? Precision::single : Precision::half;
  return DenseCodec{make_dense(t.prepared.factors, precision), t.coarse, sweeps_of(t, params)};
}

}  // namespace luxel::matrix
