// Hemicube radiosity as a solver of lightmaps.
#include "luxel/pipeline/solver/hemicube.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/settings/option_rows.h"
#include "luxel/pipeline/solver/measured_error.h"
#include "luxel/pipeline/solver/memory.h"
#include "luxel/pipeline/solver/on_device.h"
#include "luxel/pipeline/solver/solver.h"
#include "luxel/pipeline/solver/stage_seconds.h"
#include "luxel/pipeline/solver/vertex_lit.h"
#include "luxel/transport/back_faces.h"
#include "luxel/transport/covers.h"

namespace luxel::pipeline {
namespace {

using P = hemicube::HemicubeParams;
using HemicubeRows = Rows<P>;

/// 2^26: their numbers, and those of four times as many nodes, fit into 32 bits.
constexpr double kMaxElements = 1 << 26;

/// Elements are few, and their light is stretched over their triangles: shadows get more rays for
/// each of --direct-samples, as the help of that option says.
constexpr int kShadowRaysPerSample = 4, kMostShadowRaysOfElement = 65535;

/// A covered texel gets what the field has around through what is open of it. `cover_size_m`: by
/// which places are covered (transport::open_share).
TexelLight texel_light_of(const light::TexelScene& in, const hemicube::Solution& solution,
                          float cover_size_m) {
  TexelLight out;
  const atlas::TexelMap& map = in.map;
  const std::vector<float> open = transport::open_shares(in.tracer, in.elements, cover_size_m);
  out.irradiance.resize(map.texels.size());
  parallel_for(map.texels.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out.irradiance[i] = hemicube::irradiance_at(solution.field, map.texels[i].sample) * open[i];
  });
  out.hidden = transport::find_enclosed(in.scene, in.tracer, in.elements);
  out.suspicious_texels = uint64_t(std::count(out.hidden.begin(), out.hidden.end(), 1));
  out.rays = solution.rays, out.sweeps = solution.sweeps;
  out.scratch_bytes = solution.row_bytes_in_file;
  out.elements = solution.field.receivers.size();
  return out;
}

Result<TexelLight> solve_hemicube(const light::TexelScene& in, const BakeSettings& settings,
                                  const SolveStores& stores, const SolveObserver& observer,
                                  Progress& progress) {
  hemicube::HemicubeParams params = hemicube_params(settings);
  const uint64_t pixels = hemicube::bytes_of_hemicube(params.resolution, thread_count());
  LUXEL_TRY(const uint64_t memory,
            memory_to_spare(in, settings, bytes_of_light(in, settings), pixels + kMinHitBytes));
  params.row_memory_bytes = memory - pixels;
  params.scratch_folder = nearest_folder(settings.output);
  params.team = stores.team;
  const auto solve = [&](const BakeDevice* on) {
    LUXEL_CHECK(!on || on->look);
    params.device = on ? on->look : nullptr;
    return hemicube::solve(in.scene, in.lights, in.tracer, params, progress,
                           observer.hemicube ? *observer.hemicube : hemicube::Observer{});
  };
  TookPart part;
  LUXEL_TRY(const hemicube::Solution solution, run_on_any(stores.device, solve, part));
  const float cover_size_m =
      transport::size_for_covers(in.scene, in.tracer, solution.element_size_m);
  TexelLight out = texel_light_of(in, solution, cover_size_m);
  out.device = std::move(part.device), out.warnings = std::move(part.warnings);
  LUXEL_TRY(out.relative_error,
            measured_error(in, out,
                           {settings.bounces, settings.seed,
                            seconds_left(settings.time_budget_s, progress.stages())},
                           progress));
  if (settings.vertex_colors) out.vertex_lit = vertex_lit(in.scene, solution.field);
  return out;
}

/// A clause on the memory of a hemicube's pixels; empty below 0.1 GiB.
std::string hemicube_memory(int resolution) {
  const double gib = double(hemicube::bytes_of_hemicube(resolution, 1)) / double(1u << 30);
  return gib < 0.1 ? std::string() : fmt::format("; it would take {:.1f} GiB for its pixels", gib);
}

/// An even number of pixels that memory can hold.
Option<P> resolution_option() {
  Option<P> row =
      HemicubeRows::number("--hemicube", &P::resolution, {2, double(hemicube::kMaxResolution)},
                           "Pixels along an edge of the hemicube's top; an even number")
          .key_is("resolution")
          .unit("PIXELS");
  row.check = [](const P& p) -> Status {
    if (p.resolution < 2 || p.resolution > hemicube::kMaxResolution)
      return fail(ErrorCode::bad_setting, "--hemicube {} is outside 2 to {} pixels{}", p.resolution,
                  hemicube::kMaxResolution, hemicube_memory(std::max(p.resolution, 0)));
    if (p.resolution % 2 != 0)
      return fail(
          ErrorCode::bad_setting,
          "--hemicube {} is odd, and its sides are half as high as wide; give an even number",
          p.resolution);
    return {};
  };
  row.read_text = [check = row.check, read = row.read_text](P& p, std::string_view text) -> Status {
    if (const auto value = number_from<int>(text)) return p.resolution = *value, check(p);
    return read(p, text);
  };
  return row;
}

/// The time of one core per ray of a hemicube in most scenes [s].
constexpr double kLookSeconds = 1.2e-7;
/// The part of the elements that the first mesh has. Rough looks take a quarter of the last ones.
constexpr double kFirstElements = 0.35;
constexpr double kUsualElements = 20000;

/// The first looks tell anew how long those after them take.
std::vector<Stage> usual_hemicube(const BakeSettings& settings, double) {
  const hemicube::HemicubeParams params = hemicube_params(settings);
  const double elements = params.max_elements > 0 ? double(params.max_elements) : kUsualElements;
  const double last_s =
      kLookSeconds * elements * 3 * double(params.resolution) * double(params.resolution);
  if (!(params.max_error > 0))
    return {{"hemicubes", last_s}, {"trace paths", kMeasuredErrorSeconds}};
  return {{"hemicubes", kFirstElements * last_s / 4},
          {"hemicubes", (1 - kFirstElements) * last_s / 4},
          {"hemicubes", last_s},
          {"trace paths", kMeasuredErrorSeconds}};
}

}  // namespace

Options<hemicube::HemicubeParams> hemicube_options() {
  return {
      HemicubeRows::choice("--elements", &P::elements,
                           {{"vertex", hemicube::ElementKind::vertex},
                            {"triangle", hemicube::ElementKind::triangle}},
                           "Compute light per vertex or per triangle"),
      resolution_option(),
      HemicubeRows::number("--element-size", &P::element_size_m,
                           {0, kNoLimit, "is not a length; give metres > 0", "", true},
                           "Size of the initial triangles in metres (default: from --max-elements)")
          .key_is("element_size_m")
          .unit("METRES"),
      HemicubeRows::number(
          "--max-elements", &P::max_elements, {1, kMaxElements},
          "Largest number of vertices or triangles (default: 20000, more for large scenes)")
          .unit("COUNT"),
      HemicubeRows::number(
          "--max-error", &P::max_error,
          {0, 1e6, "is not a relative error; give a number, as 0.01, or 0 for no subdivision"},
          "Subdivide triangles whose relative interpolation error is larger; 0: subdivide none; "
          "default: 0.01")
          .unit("ERROR"),
      HemicubeRows::toggle("--smooth", &P::smooth, "Interpolate light computed per triangle"),
  };
}

hemicube::HemicubeParams hemicube_params(const BakeSettings& settings) {
  hemicube::HemicubeParams params = settings.own.of<hemicube::HemicubeParams>();
  params.direct_samples =
      std::min(kShadowRaysPerSample * first_direct_samples(settings), kMostShadowRaysOfElement);
  params.bounces = settings.bounces, params.seed = settings.seed;
  return params;
}

Status check_contradictions(const hemicube::HemicubeParams& params) {
  if (!params.smooth || params.elements != hemicube::ElementKind::vertex) return {};
  return fail(ErrorCode::bad_setting,
              "--smooth is for light per triangle; add --elements triangle, or leave it out, "
              "because light per vertex is smooth");
}

Solver hemicube_solver() {
  return {.name = "hemicube",
          .can = {.direct_samples = true, .teams = true, .device = true, .vertex_light = true},
          .solve = solve_hemicube,
          .usual = usual_hemicube,
          .options = options_of_solver("hemicube", kHemicubeHeading, hemicube_options()),
          .notes = {{"--direct-samples", "four times as many per element"}},
          .check = [](const BakeSettings& s) { return check_contradictions(s.own.of<P>()); }};
}

}  // namespace luxel::pipeline
