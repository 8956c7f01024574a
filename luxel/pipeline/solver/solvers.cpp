#include "luxel/pipeline/solver/solvers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/light/supersample.h"
#include "luxel/pipeline/solver/gather_light.h"
#include "luxel/pipeline/solver/hierarchical.h"
#include "luxel/pipeline/solver/solver_memory.h"
#include "luxel/pipeline/solver/texel_light.h"
#include "luxel/reference/path_tracer.h"
#include "luxel/solve/hemicube/hemicube.h"
#include "luxel/solve/hierarchical/enclosed.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/solve/hierarchical/surface.h"
#include "luxel/solve/matrix/matrix.h"
#include "luxel/transport/backs_seen.h"

namespace luxel::pipeline {
namespace {

/// A point of a texel's footprint, held twice while the list is made.
constexpr uint64_t kBytesPerFootprintPoint = 120;

Result<TexelLight> solve_reference(const SolveInput& in, const BakeSettings& settings,
                                   Progress& progress) {
  const int points = std::min(settings.supersample, settings.samples);
  const uint64_t per_element = points > 1 ? uint64_t(points) * kBytesPerFootprintPoint : 0;
  if (const auto spare = memory_to_spare(in, settings, per_element * in.elements.size()); !spare)
    return tl::unexpected(spare.error());
  const reference::PathParams params{settings.samples, settings.bounces, settings.seed};
  light::Footprints footprints;
  reference::Receivers receivers = reference::receivers(in.elements);
  if (points > 1) {
    LUXEL_TRY(footprints, light::footprints(in.scene, in.atlas, in.map, in.elements, in.tracer,
                                            points, settings.seed, progress));
    receivers = reference::receivers(footprints.points);
    receivers.first = footprints.first;
  }
  LUXEL_TRY(reference::TexelPaths result,
            reference::irradiance_by_paths(in.scene, receivers, in.tracer, params, progress));
  result.enclosed = transport::find_enclosed(in.scene, in.tracer, in.elements, [&](size_t i) {
    return transport::BacksSeen{settings.samples, int(result.met_back[i]),
                                int(result.met_double_sided_back[i])};
  });
  TexelLight out = texel_light(std::move(result));
  for (const float error : result.luminance_error) out.variance.push_back(error * error);
  return out;
}

/// Its elements are few, and their light is stretched over their triangles: shadows get more rays.
constexpr int kShadowRaysPerSample = 4;

/// Whether the field has no light of its own at a texel.
bool is_hidden_at(const hemicube::Solution& s, const scene::SurfacePoint& p) {
  const hemicube::Place place = hemicube::locate(s.field.mesh, p);
  if (s.field.receivers.kind == hemicube::ElementKind::triangle)
    return s.enclosed[s.field.receivers.leaf_of_node[place.node]];
  const auto& v = s.field.mesh.nodes[place.node].vertex;
  return s.enclosed[v[0]] && s.enclosed[v[1]] && s.enclosed[v[2]];
}

TexelLight texel_light_of(hemicube::Solution&& solution, const atlas::TexelMap& map) {
  TexelLight out;
  out.irradiance.resize(map.texels.size()), out.hidden.resize(map.texels.size());
  parallel_for(map.texels.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      out.irradiance[i] = hemicube::irradiance_at(solution.field, map.texels[i].sample);
      out.hidden[i] = is_hidden_at(solution, map.texels[i].sample);
    }
  });
  out.suspicious_texels = uint64_t(std::count(out.hidden.begin(), out.hidden.end(), 1));
  out.rays = solution.rays, out.sweeps = solution.sweeps;
  out.relative_error = solution.relative_error;
  out.scratch_bytes = solution.row_bytes_in_file;
  out.elements = solution.field.receivers.size();
  out.field = std::move(solution.field);
  return out;
}

Result<TexelLight> solve_hemicube(const SolveInput& in, const BakeSettings& settings,
                                  Progress& progress) {
  const uint64_t pixels = hemicube::bytes_of_hemicube(settings.hemicube.resolution, thread_count());
  LUXEL_TRY(const uint64_t memory, memory_to_spare(in, settings, pixels + kMinHitBytes));
  hemicube::HemicubeParams params = hemicube_params(settings);
  params.row_memory_bytes = memory - pixels;
  params.scratch_folder = nearest_folder(settings.output);
  LUXEL_TRY(hemicube::Solution solution,
            hemicube::solve(in.scene, in.lights, in.tracer, params, progress));
  return texel_light_of(std::move(solution), in.map);
}

/// Direct light for each texel, indirect light for each patch.
Result<TexelLight> solve_matrix(const SolveInput& in, const BakeSettings& settings,
                                Progress& progress) {
  const matrix::MatrixParams params = matrix_params(settings);
  const uint64_t needed =
      matrix::bytes_of_preparation(params.patches.count, params.factors.rays_per_patch);
  if (const auto spare = memory_to_spare(in, settings, needed); !spare)
    return tl::unexpected(spare.error());
  LUXEL_TRY(const matrix::Prepared prepared,
            matrix::prepare(in.scene, in.tracer, params, progress));
  LUXEL_TRY(const matrix::Solution solution,
            matrix::solve(in.scene, in.lights, in.tracer, prepared, params, progress));
  LUXEL_TRY(const matrix::Transfer map,
            matrix::make_transfer(prepared.work, in.tracer,
                                  {in.elements.position, in.elements.geometric_normal}, progress));
  const light::DirectParams direct_params{settings.direct_samples, settings.seed};
  LUXEL_TRY(light::DirectLight direct, light::direct_light(in.scene, in.elements, in.lights,
                                                           in.tracer, direct_params, progress));
  LUXEL_TRY(const light::Supersampled averaged,
            light::supersample(in.scene, in.atlas, in.map, in.elements, in.lights, in.tracer,
                               {.points = settings.supersample, .direct = direct_params}, direct,
                               progress));
  TexelLight out;
  out.irradiance.resize(in.elements.size()), out.hidden.resize(in.elements.size());
  matrix::transfer(map, solution.indirect, out.irradiance);
  parallel_for(in.elements.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      out.irradiance[i] += direct.irradiance[i];
      out.hidden[i] =
          matrix::is_hidden(in.scene, in.tracer, prepared.work, in.map.texels[i].sample);
    }
  });
  out.suspicious_texels = uint64_t(std::count(out.hidden.begin(), out.hidden.end(), 1));
  // What patches exchange has no grain: every texel reads it through the same smooth functions.
  out.variance.assign(in.elements.size(), 0.0f);
  out.direct = std::move(direct.irradiance);
  out.direct_variance = std::move(direct.variance);
  out.supersampled_texels = averaged.texels.size();
  out.rays = solution.rays + direct.rays + averaged.rays, out.sweeps = solution.sweeps;
  out.elements = prepared.work.patches.size();
  out.relative_error = solution.relative_error;
  return out;
}

/// Texels at which the interpolants are held against exact irradiance.
constexpr size_t kCheckedTexels = 400;

/// Root mean square difference between interpolated and exact irradiance over the mean.
Result<double> interpolation_error(const SolveInput& in, const hierarchical::Solution& solution,
                                   std::span<const Rgb> interpolated, Progress& progress) {
  std::vector<hierarchical::Receiver> receivers;
  std::vector<size_t> texels;
  const size_t step = std::max<size_t>(1, in.map.texels.size() / kCheckedTexels);
  for (size_t i = step / 2; i < in.map.texels.size(); i += step) {
    const hierarchical::Place place =
        hierarchical::place_of(in.scene, solution.faces, in.map.texels[i].sample);
    if (place.face == hierarchical::kNone) continue;
    receivers.push_back(
        hierarchical::receiver_at(solution, in.scene, in.tracer, place.face, place.position));
    texels.push_back(i);
  }
  LUXEL_TRY(const std::vector<Rgb> exact,
            hierarchical::irradiance_at(solution, in.scene, in.tracer, receivers, {}, progress));
  double squares = 0, sum = 0;
  for (size_t k = 0; k < texels.size(); ++k) {
    const double d = double(luminance(interpolated[texels[k]] - exact[k]));
    squares += d * d, sum += double(luminance(exact[k]));
  }
  return sum > 0 ? std::sqrt(squares * double(texels.size())) / sum : 0;
}

Result<TexelLight> solve_hierarchical(const SolveInput& in, const BakeSettings& settings,
                                      Progress& progress) {
  if (const auto spare = memory_to_spare(in, settings, 0); !spare)
    return tl::unexpected(spare.error());
  LUXEL_TRY(hierarchical::Solution solution,
            hierarchical::solve(in.scene, in.tracer,
                                solve_params(settings.hierarchical, settings.bounces), progress));
  LUXEL_TRY(const hierarchical::LightMesh mesh,
            hierarchical::represent(solution, in.scene, in.tracer,
                                    light_mesh_params(settings.hierarchical), {}, progress));
  TexelLight out;
  out.irradiance.resize(in.map.texels.size()), out.hidden.resize(in.map.texels.size());
  parallel_for(in.map.texels.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out.irradiance[i] =
          hierarchical::irradiance_at(solution, mesh, in.scene, in.map.texels[i].sample);
  });
  out.hidden = hierarchical::find_enclosed(in.scene, in.tracer, in.elements.position,
                                           in.elements.geometric_normal, out.irradiance);
  out.suspicious_texels = uint64_t(std::count(out.hidden.begin(), out.hidden.end(), 1));
  out.sweeps = solution.sweeps, out.elements = mesh.triangles.size();
  out.warnings = solution.warnings;
  LUXEL_TRY(out.relative_error, interpolation_error(in, solution, out.irradiance, progress));
  return out;
}

constexpr std::array kSolvers{
    Solver{.name = "gather",
           .solve = solve_gather,
           .samples = true,
           .direct_samples = true,
           .supersample = true,
           .max_error = true,
           .errors = true,
           .noise = true,
           .layers = true,
           .scatters = true,
           .parts = true,
           .keeps = true},
    Solver{.name = "hemicube",
           .solve = solve_hemicube,
           .direct_samples = true,
           .hemicube = true,
           .max_error = true},
    Solver{.name = "matrix",
           .solve = solve_matrix,
           .direct_samples = true,
           .supersample = true,
           .matrix = true,
           .noise = true},
    Solver{.name = "hierarchical", .solve = solve_hierarchical, .hierarchical = true},
    Solver{.name = "reference",
           .solve = solve_reference,
           .samples = true,
           .supersample = true,
           .noise = true,
           .scatters = true}};

}  // namespace

hemicube::HemicubeParams hemicube_params(const BakeSettings& settings) {
  hemicube::HemicubeParams params;
  params.elements = settings.hemicube.elements == "triangle" ? hemicube::ElementKind::triangle
                                                             : hemicube::ElementKind::vertex;
  params.resolution = settings.hemicube.resolution;
  params.element_size_m = float(settings.hemicube.element_size_m);
  params.max_elements = size_t(settings.hemicube.max_elements);
  params.max_error = float(settings.hemicube.max_error);
  params.smooth = settings.hemicube.smooth;
  params.direct_samples = std::min(kShadowRaysPerSample * settings.direct_samples, 65535);
  params.bounces = settings.bounces;
  params.seed = settings.seed;
  return params;
}

matrix::MatrixParams matrix_params(const BakeSettings& settings) {
  matrix::MatrixParams params;
  params.patches.count = size_t(settings.matrix.patches);
  params.factors.rays_per_patch = settings.matrix.rays;
  params.direct_samples = settings.direct_samples;
  params.bounces = settings.bounces;
  params.seed = params.patches.seed = params.factors.seed = settings.seed;
  return params;
}

std::span<const Solver> solvers() { return kSolvers; }

const Solver* find_solver(std::string_view name) {
  const auto found = std::find_if(kSolvers.begin(), kSolvers.end(),
                                  [&](const Solver& solver) { return solver.name == name; });
  return found == kSolvers.end() ? nullptr : &*found;
}

std::string solver_names() {
  std::string names;
  for (const Solver& solver : kSolvers)
    names += (names.empty() ? "" : ", ") + std::string(solver.name);
  return names;
}

}  // namespace luxel::pipeline
