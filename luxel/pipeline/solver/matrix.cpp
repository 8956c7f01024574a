// Radiosity by a matrix of form factors, as a solver of lightmaps.
#include "luxel/pipeline/solver/matrix.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/light/point_error.h"
#include "luxel/light/supersample.h"
#include "luxel/pipeline/settings/option_rows.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/solver.h"
#include "luxel/pipeline/solver/texel_light.h"
#include "luxel/pipeline/texels/two_sides.h"
#include "luxel/transport/back_faces.h"

namespace luxel::pipeline {
namespace {

/// Rays of a patch are counted in 16 bits.
constexpr double kMaxRays = 65535;

/// Radiosity of the patch that a ray meets.
Rgb patch_radiosity(const light::TexelScene& in, const matrix::PatchedScene& patched,
                    const matrix::Solution& solution, const trace::Hit& hit) {
  const uint32_t j = matrix::patch_met(patched, in.scene, in.tracer, hit);
  if (j == matrix::kNone) return {};
  return patched.patches.elements.reflectance[j] * (solution.direct[j] + solution.indirect[j]);
}

/// Direct light for each texel, indirect light for each patch.
Result<TexelLight> solve_matrix(const light::TexelScene& in, const BakeSettings& settings,
                                const SolveStores& stores, const SolveObserver&,
                                Progress& progress) {
  matrix::MatrixParams params = settings.own.of<matrix::MatrixParams>();
  params.direct_samples = first_direct_samples(settings), params.bounces = settings.bounces;
  params.seed = params.patches.seed = params.factors.seed = settings.seed;
  LUXEL_TRY(params.patches.open_backs, open_backs(in.scene, progress));
  const uint64_t needed =
      matrix::bytes_of_preparation(params.patches.count, params.factors.rays_per_patch);
  LUXEL_TRY_STATUS(memory_to_spare(in, settings, bytes_of_light(in, settings), needed));
  LUXEL_TRY(const matrix::Prepared prepared,
            matrix::prepare(in.scene, in.tracer, params, progress, stores.team));
  LUXEL_TRY(const matrix::Solution solution,
            matrix::solve(in.scene, in.lights, in.tracer, prepared, params, progress));
  LUXEL_TRY(const matrix::Transfer map,
            matrix::make_transfer(prepared.patched, in.tracer,
                                  {in.elements.position, in.elements.geometric_normal}, progress));
  light::SupersampleParams of_direct{.points = first_supersample(settings),
                                     .direct = {first_direct_samples(settings), settings.seed}};
  of_direct.direct.team = stores.team;
  LUXEL_TRY(light::DirectLight direct, light::direct_light(in.scene, in.elements, in.lights,
                                                           in.tracer, of_direct.direct, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(in, of_direct, direct, progress));
  TexelLight out;
  out.irradiance.resize(in.elements.size());
  matrix::transfer(map, solution.indirect, out.irradiance);
  out.hidden = transport::find_enclosed(in.scene, in.tracer, in.elements);
  const auto radiosity = [&](const trace::Hit& hit) {
    return patch_radiosity(in, prepared.patched, solution, hit);
  };
  parallel_for(in.elements.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out.irradiance[i] += direct.irradiance[i];
  });
  LUXEL_TRY(out.answers, light::point_answers({in, radiosity, direct.variance, of_direct},
                                              out.hidden, progress));
  out.suspicious_texels = uint64_t(std::count(out.hidden.begin(), out.hidden.end(), 1));
  // What patches exchange has no grain: every texel reads it through the same smooth functions.
  out.variance.assign(in.elements.size(), 0.0f);
  out.direct = std::move(direct.irradiance);
  out.direct_variance = std::move(direct.variance);
  out.supersampled_texels = averaged.texels.size();
  out.rays = solution.rays + direct.rays + averaged.rays, out.sweeps = solution.sweeps;
  out.elements = prepared.patched.patches.size();
  const double mean = mean_light(out);
  const double error = light::point_error(out.answers, out.irradiance);
  out.relative_error = std::hypot(solution.relative_error, mean > 0 ? error / mean : 0);
  out.relative_unseen = solution.relative_error;
  return out;
}

/// The time of one core in most scenes [s]: per ray of a patch, and per patch to make it; per texel
/// for its direct light and to read patches.
constexpr double kFactorSeconds = 1.9e-7, kPatchSeconds = 1.1e-4;
constexpr double kTexelSeconds = 3e-5;

std::vector<Stage> usual_matrix(const BakeSettings& settings, double texels) {
  const auto params = settings.own.of<matrix::MatrixParams>();
  const double patches = double(params.patches.count);
  const double texels_s = kTexelSeconds * texels;
  return {{"patches", kPatchSeconds * patches},
          {"form factors", kFactorSeconds * patches * params.factors.rays_per_patch},
          {"direct light", kPatchSeconds * patches},
          {"transfer", 0.2 * texels_s},
          {"direct light", 0.3 * texels_s},
          {"supersample", 0.2 * texels_s},
          {"check", 0.3 * texels_s}};
}

}  // namespace

Options<matrix::MatrixParams> matrix_options() {
  using R = Rows<matrix::MatrixParams>;
  return {
      R::number(
          "--patches", [](auto& p) -> auto& { return p.patches.count; },
          {1, double(matrix::kMaxPatches)}, "Approximate number of patches")
          .unit("COUNT"),
      R::number(
          "--rays", [](auto& p) -> auto& { return p.factors.rays_per_patch; }, {1, kMaxRays},
          "Rays per patch to estimate its form factors")
          .unit("COUNT"),
  };
}

Solver matrix_solver() {
  return {.name = "matrix",
          .can = {.direct_samples = true, .supersample = true, .noise = true, .teams = true},
          .solve = solve_matrix,
          .usual = usual_matrix,
          .options = options_of_solver("matrix", "Matrix radiosity", matrix_options())};
}

}  // namespace luxel::pipeline
