#include "pipeline/solvers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "pipeline/hierarchical.h"
#include "pipeline/memory.h"
#include "pipeline/output_folder.h"
#include "reference/path_tracer.h"
#include "solve/gather/gather.h"
#include "solve/hemicube/hemicube.h"
#include "solve/hierarchical/enclosed.h"
#include "solve/hierarchical/represent.h"
#include "solve/hierarchical/surface.h"
#include "solve/matrix/matrix.h"
#include "transport/supersample.h"

namespace luxel::pipeline {
namespace {

/// What gather and the steps after it need besides the stored hits, per element and per texel of
/// the square: direct light, two maps of irradiance, variances, two radiosity maps; later, when the
/// hits are gone, the lightmap and its encoded files, which take less. Paths need about the same:
/// three results of 12 bytes per element, and less per texel.
constexpr uint64_t kBytesPerElement = 72, kBytesPerSquareTexel = 20;
/// A point of a texel's footprint, held twice while the list is made.
constexpr uint64_t kBytesPerFootprintPoint = 120;
/// What denoising needs besides: places, planes, what neighbours show, the level of noise.
constexpr uint64_t kDenoiseBytesPerElement = 140;
/// E for five normals and what becomes of it, with --directional.
constexpr uint64_t kDirectionBytesPerElement = 110;
/// With --layers each takes, per element: direct light, that of rays, the solution and its copy,
/// later the lightmap and its files; and a sweep's map, which is five layers wide, per texel.
constexpr uint64_t kLayerBytesPerElement = 48, kLayerMapBytesPerSquareTexel = 64;
/// A bake with fewer stored hits in memory than this would only wait for the disk.
constexpr uint64_t kMinHitBytes = 16u << 20;
/// What the process holds differs from run to run: by this much less than the size that is advised.
constexpr uint64_t kResidentNoiseMb = 8;

std::string size_text(uint64_t bytes) {
  return bytes < 1u << 20 ? fmt::format("{} bytes", bytes) : fmt::format("{}M", bytes >> 20);
}

/// How many bytes a solver may use beyond what it needs at least. Fails when that is less than
/// `spare`.
Result<uint64_t> memory_to_spare(const SolveInput& in, const BakeSettings& settings, uint64_t spare,
                                 size_t layers = 0) {
  const uint64_t side = uint64_t(in.map.resolution);
  // What comes after solving: not all of it at once, but most.
  uint64_t per_element = kBytesPerElement;
  if (settings.denoise) per_element += kDenoiseBytesPerElement;
  if (settings.directional != Directional::none) per_element += kDirectionBytesPerElement;
  per_element += layers * kLayerBytesPerElement;
  const uint64_t per_texel = kBytesPerSquareTexel + (layers > 0 ? kLayerMapBytesPerSquareTexel : 0);
  const uint64_t needed =
      resident_bytes() + per_element * in.elements.size() + per_texel * side * side;
  const uint64_t smallest_mb = ((needed + spare) >> 20) + 1 + kResidentNoiseMb;
  if (settings.max_memory_bytes == 0) {
    const uint64_t free = available_bytes() / 5 * 4;
    if (resident_bytes() + free >= needed + spare) return resident_bytes() + free - needed;
    return fail(ErrorCode::out_of_memory,
                "{} x {} texels need {}M of memory, more than is free; lower --resolution", side,
                side, smallest_mb);
  }
  if (settings.max_memory_bytes < needed + spare)
    return fail(
        ErrorCode::out_of_memory,
        "--max-memory {} is too small for this scene at {} x {}: the smallest that works is {}M",
        size_text(settings.max_memory_bytes), side, side, smallest_mb);
  return settings.max_memory_bytes - needed;
}

/// What gather and the path tracer call by the same names.
template <class Solved>
TexelLight texel_light(Solved&& solved) {
  TexelLight out;
  out.suspicious_texels = uint64_t(std::count(solved.enclosed.begin(), solved.enclosed.end(), 1));
  out.hidden = std::move(solved.enclosed);
  out.irradiance = std::move(solved.irradiance);
  out.rays = solved.rays;
  out.relative_error = solved.relative_error;
  return out;
}

/// Of the first round, when an error is asked for.
constexpr int kFirstSamples = 32;

void warn_about_error(const BakeSettings& settings, const gather::GatherParams& params,
                      const gather::Gather& result, std::vector<std::string>& warnings) {
  if (settings.samples_given)
    warnings.push_back(
        fmt::format("--max-error {} wins: rays are added until it is reached, and --samples {} is "
                    "not looked at",
                    settings.max_error, settings.samples));
  if (double(result.relative_error_p95) > settings.max_error)
    warnings.push_back(
        fmt::format("--max-error {} was not reached: 95 of 100 texels are known to {:.2g} of their "
                    "light, and none gets more than {} rays",
                    settings.max_error, result.relative_error_p95, params.max_samples));
}

Result<TexelLight> solve_gather(const SolveInput& in, const BakeSettings& settings,
                                Progress& progress) {
  transport::LightLayers layers;
  if (settings.layers != transport::LayerMode::none) {
    LUXEL_TRY(layers, transport::light_layers(in.scene, in.lights, settings.layers));
  }
  LUXEL_TRY(const uint64_t hit_memory, memory_to_spare(in, settings, kMinHitBytes, layers.size()));
  gather::GatherParams params;
  params.samples = settings.max_error > 0 ? kFirstSamples : settings.samples;
  params.max_error = float(settings.max_error);
  params.direct_samples = settings.direct_samples;
  params.supersample = settings.supersample;
  params.bounces = settings.bounces;
  params.seed = settings.seed;
  params.layers = layers.size() > 0 ? &layers : nullptr;
  params.hit_memory_bytes = hit_memory;
  params.scratch_folder = nearest_folder(settings.output);
  LUXEL_TRY(gather::Gather result, gather::gather(in.scene, in.atlas, in.map, in.elements,
                                                  in.lights, in.tracer, params, progress));
  TexelLight out = texel_light(std::move(result));
  if (settings.max_error > 0) warn_about_error(settings, params, result, out.warnings);
  out.errors = std::move(result.errors), out.error_p95 = result.relative_error_p95;
  out.samples = std::move(result.samples);
  out.layers = std::move(layers.layers), out.layer_irradiance = std::move(result.layers);
  out.direct = std::move(result.direct);
  out.direct_variance = std::move(result.direct_variance);
  out.variance = std::move(result.indirect_variance);
  out.sweeps = result.sweeps, out.supersampled_texels = result.supersampled;
  out.scratch_bytes = result.hit_bytes_in_file;
  return out;
}

Result<TexelLight> solve_reference(const SolveInput& in, const BakeSettings& settings,
                                   Progress& progress) {
  const int points = std::min(settings.supersample, settings.samples);
  const uint64_t per_element = points > 1 ? uint64_t(points) * kBytesPerFootprintPoint : 0;
  if (const auto spare = memory_to_spare(in, settings, per_element * in.elements.size()); !spare)
    return tl::unexpected(spare.error());
  const reference::PathParams params{settings.samples, settings.bounces, settings.seed};
  transport::Footprints footprints;
  reference::Receivers receivers = reference::receivers(in.elements);
  if (points > 1) {
    LUXEL_TRY(footprints, transport::footprints(in.scene, in.atlas, in.map, in.elements, in.tracer,
                                                points, settings.seed, progress));
    receivers = reference::receivers(footprints.points);
    receivers.first = footprints.first;
  }
  LUXEL_TRY(reference::TexelPaths result,
            reference::irradiance_by_paths(in.scene, receivers, in.tracer, params, progress));
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
  const transport::DirectParams direct_params{settings.direct_samples, settings.seed};
  LUXEL_TRY(transport::DirectLight direct,
            transport::direct_light(in.scene, in.elements, in.lights, in.tracer, direct_params,
                                    progress));
  LUXEL_TRY(const transport::Supersampled averaged,
            transport::supersample(in.scene, in.atlas, in.map, in.elements, in.lights, in.tracer,
                                   {.points = settings.supersample, .direct = direct_params},
                                   direct, progress));
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
           .noise = true,
           .layers = true,
           .scatters = true},
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
