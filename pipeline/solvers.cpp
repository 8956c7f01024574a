#include "pipeline/solvers.h"

#include <algorithm>
#include <array>

#include "pipeline/memory.h"
#include "solve/gather/gather.h"

namespace luxel::pipeline {
namespace {

/// What gather and the steps after it need besides the stored hits, per element and per texel of
/// the square: direct light, two maps of irradiance, variances, two radiosity maps; later, when the
/// hits are gone, the lightmap and its encoded files, which take less.
constexpr uint64_t kBytesPerElement = 64, kBytesPerSquareTexel = 20;
/// A bake with fewer stored hits in memory than this would only wait for the disk.
constexpr uint64_t kMinHitBytes = 16u << 20;

Result<uint64_t> memory_for_hits(const SolveInput& in, const BakeSettings& settings) {
  const uint64_t side = uint64_t(in.map.resolution);
  const uint64_t needed =
      resident_bytes() + kBytesPerElement * in.elements.size() + kBytesPerSquareTexel * side * side;
  const uint64_t limit = settings.max_memory_bytes > 0
                             ? settings.max_memory_bytes
                             : resident_bytes() + available_bytes() / 5 * 4;
  if (limit < needed + kMinHitBytes)
    return fail(
        ErrorCode::out_of_memory,
        "--max-memory {}M is too small for this scene at {} x {}: the smallest that works is "
        "{}M",
        limit >> 20, side, side, ((needed + kMinHitBytes) >> 20) + 1);
  return limit - needed;
}

Result<TexelLight> solve_gather(const SolveInput& in, const BakeSettings& settings,
                                Progress& progress) {
  LUXEL_TRY(const uint64_t hit_memory, memory_for_hits(in, settings));
  gather::GatherParams params;
  params.samples = settings.samples;
  params.direct_samples = settings.direct_samples;
  params.bounces = settings.bounces;
  params.seed = settings.seed;
  params.hit_memory_bytes = hit_memory;
  params.scratch_folder = settings.output;
  LUXEL_TRY(gather::Gather result, gather::gather(in.scene, in.atlas, in.map, in.elements,
                                                  in.lights, in.tracer, params, progress));
  TexelLight out;
  out.suspicious_texels = uint64_t(std::count(result.enclosed.begin(), result.enclosed.end(), 1));
  out.hidden = std::move(result.enclosed);
  out.irradiance = std::move(result.irradiance);
  out.rays = result.rays;
  out.sweeps = result.sweeps;
  out.relative_error = result.relative_error;
  out.scratch_bytes = result.hit_bytes_in_file;
  return out;
}

constexpr std::array kSolvers{Solver{"gather", solve_gather}};

}  // namespace

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
