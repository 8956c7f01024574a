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

/// Radiosity of a patch.
Rgb sent_by(const matrix::PatchedScene& patched, const matrix::Solution& solution, uint32_t j) {
  return patched.patches.elements.reflectance[j] * (solution.direct[j] + solution.indirect[j]);
}

/// Radiosity of the patch that a ray meets.
Rgb patch_radiosity(const light::TexelScene& in, const matrix::PatchedScene& patched,
                    const matrix::Solution& solution, const trace::Hit& hit) {
  const uint32_t j = matrix::patch_met(patched, in.scene, in.tracer, hit);
  return j == matrix::kNone ? Rgb{} : sent_by(patched, solution, j);
}

/// A part of itself by which light is too much, and its variance.
struct Excess {
  double part = 0, variance = 0;
};

/// Sums over texels that tell such a part.
struct ExcessSums {
  double off = 0, all = 0, squares = 0;

  /// `unsure`: the part of the term's square that chance has.
  void add(double weight, double off_here, double here, double unsure) {
    off += weight * off_here, all += weight * here;
    squares += weight * weight * off_here * off_here * unsure;
  }
  double value() const { return all > 0 ? off / all : 0; }
  double variance() const { return all > 0 ? squares / (all * all) : 0; }
};

/// So many texels tell what patches send: to a hundredth of how far those differ.
constexpr size_t kTexelsAtPatches = 10000;

/// By how much of itself the light that patches send is too much, where the texels lie: first over
/// what texels hold, then what these hold over the answers, which are right but for what is sent.
/// Covered texels have no patch: next to nothing of their light comes out of the gap.
Excess excess_of_patches(const light::TexelScene& in, const matrix::Prepared& prepared,
                         const matrix::Solution& solution, const TexelLight& light) {
  const auto patch_of = [&](size_t i) {
    const scene::SurfacePoint& p = in.map.texels[i].sample;
    return matrix::patch_met(prepared.patched, in.scene, in.tracer,
                             {0, p.instance, p.triangle, p.at});
  };
  const auto sent = [&](size_t i, Rgb e) {
    return double(luminance(in.elements.reflectance[i] * e));
  };
  ExcessSums held, answered;
  const size_t step = std::max<size_t>(1, light.irradiance.size() / kTexelsAtPatches);
  // Where all of them are looked at, there is no chance.
  const double left_out = 1 - 1 / double(step);
  for (size_t i = 0; i < light.irradiance.size(); i += step) {
    const uint32_t j = light.hidden[i] ? matrix::kNone : patch_of(i);
    if (j == matrix::kNone) continue;
    const double own = sent(i, light.irradiance[i]);
    held.add(1, double(luminance(sent_by(prepared.patched, solution, j))) - own, own, left_out);
  }
  const double visible = double(std::ranges::count(light.hidden, 0));
  for (size_t k = 0; k < light.answers.elements.size(); ++k) {
    const uint32_t i = light.answers.elements[k];
    if (patch_of(i) == matrix::kNone) continue;
    const Rgb answer = 0.5f * (light.answers.first[k] + light.answers.second[k]);
    // A texel that was sure to be chosen has the weight of one among all.
    const double weight = light.answers.weight[k], by_chance = 1 - 1 / (weight * visible);
    answered.add(weight, sent(i, light.irradiance[i] - answer), sent(i, answer),
                 std::max(0.0, by_chance));
  }
  return {held.value() + answered.value(), held.variance() + answered.variance()};
}

/// Root mean square error over the mean light of what patches exchange, since what they send is off
/// by a part that they share: two standard errors more than was found. It acts like brighter or
/// weaker lamps, so the light that arrives after reflections has `gain` times that part: all light
/// that is sent over that which has not been reflected before. Answers read the same patches and do
/// not show it.
double exchange_error(const light::TexelScene& in, const matrix::Prepared& prepared,
                      const matrix::Solution& solution, const TexelLight& light) {
  const matrix::Patches& patches = prepared.patched.patches;
  std::vector<Rgb> sent(patches.size()), reflected(patches.size());
  for (size_t j = 0; j < sent.size(); ++j)
    sent[j] = sent_by(prepared.patched, solution, uint32_t(j));
  matrix::multiply(prepared.factors, sent, reflected);
  double all = 0, first = 0, squares = 0, sum = 0, area = 0;
  for (size_t j = 0; j < sent.size(); ++j) {
    const double a = double(patches.area_m2[j]), r = double(luminance(reflected[j]));
    const Rgb again = patches.elements.reflectance[j] * reflected[j];
    all += a * double(luminance(sent[j])), first += a * double(luminance(sent[j] - again));
    squares += a * r * r, area += a;
    sum += a * double(luminance(solution.direct[j] + solution.indirect[j]));
  }
  if (!(first > 0 && sum > 0)) return 0;
  const Excess excess = excess_of_patches(in, prepared, solution, light);
  const double p2 = excess.part * excess.part, v = excess.variance;
  const double square = std::max(0.0, p2 - v + 2 * std::sqrt(4 * p2 * v + 2 * v * v));
  return all / first * std::sqrt(square * squares / area) * area / sum;
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
  // Patches exchange light without grain: every texel reads it through the same smooth functions.
  out.variance.assign(in.elements.size(), 0.0f);
  out.direct = std::move(direct.irradiance);
  out.direct_variance = std::move(direct.variance);
  out.supersampled_texels = averaged.texels.size();
  out.rays = solution.rays + direct.rays + averaged.rays, out.sweeps = solution.sweeps;
  out.elements = prepared.patched.patches.size();
  const double mean = mean_light(out);
  const double error = light::point_error(out.answers, out.irradiance);
  const double exchanged = settings.bounces == 0 ? 0 : exchange_error(in, prepared, solution, out);
  out.relative_unseen = std::hypot(solution.relative_error, exchanged);
  out.relative_error = std::hypot(out.relative_unseen, mean > 0 ? error / mean : 0);
  return out;
}

/// The time of one core in most scenes [s]: to see which backs are open; per patch to make it, to
/// light it, and per ray of it; per texel to read patches, to light it, and to look at borders of
/// shadows; and for answers at points.
constexpr double kSidesSeconds = 1.1;
constexpr double kPatchSeconds = 1.3e-4, kPatchLightSeconds = 3e-4, kFactorSeconds = 1.9e-7;
constexpr double kTransferSeconds = 6e-6, kTexelLightSeconds = 8e-6, kBorderSeconds = 6e-6;
constexpr double kCheckSeconds = 0.5;

std::vector<Stage> usual_matrix(const BakeSettings& settings, double texels) {
  const auto params = settings.own.of<matrix::MatrixParams>();
  const double patches = double(params.patches.count);
  return {{"sides", kSidesSeconds},
          {"patches", kPatchSeconds * patches},
          {"form factors", kFactorSeconds * patches * params.factors.rays_per_patch},
          {"direct light", kPatchLightSeconds * patches},
          {"transfer", kTransferSeconds * texels},
          {"direct light", kTexelLightSeconds * texels},
          {"supersample", kBorderSeconds * texels},
          {"check", kCheckSeconds}};
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
