#include <array>
#include <cstdio>
#include <set>

#include "apps/cli/cli.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::cli {
namespace {

struct BakeOptions {
  Common common;
  OutsideText outside;
  std::string uv = "auto", bounces = "inf", max_memory, formats = "exr", directional, pages = "1",
              layers;
  bool resolution_given = false, plan = false;
  HemicubeOptions hemicube;
  pipeline::BakeSettings settings;
  std::set<std::string> given;  ///< of kSolverOptions
};

/// Options that only some solvers look at.
struct SolverOption {
  const char* name;
  bool pipeline::Solver::*used;
};
constexpr std::array kSolverOptions{
    SolverOption{"--samples", &pipeline::Solver::samples},
    SolverOption{"--direct-samples", &pipeline::Solver::direct_samples},
    SolverOption{"--supersample", &pipeline::Solver::supersample},
    SolverOption{"--time-budget", &pipeline::Solver::errors},
    SolverOption{"--error-map", &pipeline::Solver::errors},
    SolverOption{"--plan", &pipeline::Solver::errors},
    SolverOption{"--denoise", &pipeline::Solver::noise},
    SolverOption{"--checkpoint", &pipeline::Solver::parts},
    SolverOption{"--resume", &pipeline::Solver::parts},
    SolverOption{"--keep", &pipeline::Solver::keeps},
    SolverOption{"--layers", &pipeline::Solver::layers},
    SolverOption{"--elements", &pipeline::Solver::hemicube},
    SolverOption{"--hemicube", &pipeline::Solver::hemicube},
    SolverOption{"--element-size", &pipeline::Solver::hemicube},
    SolverOption{"--max-elements", &pipeline::Solver::hemicube},
    SolverOption{"--max-error", &pipeline::Solver::max_error},
    SolverOption{"--smooth", &pipeline::Solver::hemicube},
    SolverOption{"--patches", &pipeline::Solver::matrix},
    SolverOption{"--rays", &pipeline::Solver::matrix},
    SolverOption{"--eps", &pipeline::Solver::hierarchical},
    SolverOption{"--min-area", &pipeline::Solver::hierarchical},
    SolverOption{"--no-discontinuities", &pipeline::Solver::hierarchical},
    SolverOption{"--max-leaf-lines", &pipeline::Solver::hierarchical},
    SolverOption{"--min-weight", &pipeline::Solver::hierarchical},
    SolverOption{"--ranking", &pipeline::Solver::hierarchical}};

/// "gather, ...": the solvers that look at an option.
std::string users_of(bool pipeline::Solver::*used) {
  std::string names;
  for (const pipeline::Solver& solver : pipeline::solvers())
    if (solver.*used) names += (names.empty() ? "" : ", ") + std::string(solver.name);
  return names;
}

/// What a solver would not look at must not be given: its user expects something of it.
Status check_used(const BakeOptions& options) {
  const pipeline::BakeSettings& s = options.settings;
  const pipeline::Solver* solver = pipeline::find_solver(s.solver);
  if (!solver) return {};  // the bake says so
  for (const SolverOption& option : kSolverOptions)
    if (options.given.contains(option.name) && !(solver->*option.used))
      return fail(ErrorCode::bad_setting,
                  "--solver {} does not use {}; leave {} out (it is for {})", s.solver, option.name,
                  option.name, users_of(option.used));
  const pipeline::HemicubeSettings& hemicube = options.hemicube.settings;
  if (hemicube.smooth && hemicube.elements == "vertex")
    return fail(ErrorCode::bad_setting,
                "--smooth is for light per triangle; add --elements triangle, or leave it out, for "
                "light per vertex is smooth");
  return {};
}

Result<pipeline::BakeSettings> settings_from(const BakeOptions& options) {
  LUXEL_TRY_STATUS(check_used(options));
  pipeline::BakeSettings s = options.settings;
  LUXEL_TRY(s.pages, pipeline::parse_pages(options.pages));
  if (options.resolution_given && s.texels_per_metre > 0 &&
      s.pages.mode != atlas::PageMode::automatic)
    return fail(
        ErrorCode::bad_setting,
        "--resolution {} and --texels-per-metre {} contradict each other; leave one out, or "
        "add --pages auto, which takes as many lightmaps of that resolution as it needs",
        s.resolution, s.texels_per_metre);
  s.threads = options.common.threads;
  s.hemicube = options.hemicube.settings;
  if (s.solver == "gather" && options.given.contains("--max-error")) {
    s.max_error = s.hemicube.max_error;
    if (s.max_error == 0)
      return fail(
          ErrorCode::bad_setting,
          "--max-error 0 would never end; give the part of their light to which texels must "
          "be known, as 0.02");
  }
  if (options.given.contains("--time-budget") && s.time_budget_s <= 0)
    return fail(ErrorCode::bad_setting,
                "--time-budget {} is not a time to bake in; give seconds, as 60", s.time_budget_s);
  s.samples_given = options.given.contains("--samples");
  s.uv = uv_mode(options.uv);
  LUXEL_TRY(s.bounces, pipeline::parse_bounces(options.bounces));
  if (!options.max_memory.empty()) {
    LUXEL_TRY(s.max_memory_bytes, pipeline::parse_size(options.max_memory));
  }
  LUXEL_TRY(s.outside, parse_outside_light(options.outside));
  LUXEL_TRY(s.formats, pipeline::parse_formats(options.formats));
  if (!options.directional.empty()) {
    LUXEL_TRY(s.directional, pipeline::parse_directional(options.directional));
  }
  if (!options.layers.empty()) {
    LUXEL_TRY(s.layers, pipeline::parse_layers(options.layers));
  }
  return s;
}

void print_summary(const pipeline::BakeSettings& settings, const nlohmann::json& json) {
  const auto& counts = json["counts"];
  const size_t pages = json["atlas"]["pages"].size();
  std::fprintf(
      stderr, "%s\n",
      fmt::format("{} triangles, {} charts, {}{} x {} texels ({} used), {} rays in {:.1f} s, "
                  "estimated error {:.2f} %",
                  counts["triangles"].get<uint64_t>(), counts["charts"].get<uint64_t>(),
                  pages == 1 ? "" : fmt::format("{} pages of up to ", pages),
                  json["atlas"]["resolution"].get<int>(), json["atlas"]["resolution"].get<int>(),
                  counts["texels"].get<uint64_t>(), counts["rays"].get<uint64_t>(),
                  json["seconds"]["total"].get<double>(),
                  100 * json["relative_error"].get<double>())
          .c_str());
  for (const nlohmann::json& name : json["files"])
    std::fprintf(stderr, "wrote %s\n", (settings.output / name.get<std::string>()).c_str());
}

void print_plan(const nlohmann::json& json) {
  std::fprintf(
      stderr, "%s\n",
      fmt::format("plan: about {}, {:.0f}M of memory{}, {:.0f} million rays, for {} texels "
                  "on {} x {}; nothing was baked",
                  clock_text(json["seconds"]["total"].get<double>()),
                  json["memory_bytes"].get<double>() / double(1u << 20),
                  json["scratch_bytes"].get<double>() > 0
                      ? fmt::format(" and {:.0f}M of temporary files",
                                    json["scratch_bytes"].get<double>() / double(1u << 20))
                      : std::string(),
                  json["rays"].get<double>() * 1e-6, json["texels"].get<uint64_t>(),
                  json["resolution"].get<int>(), json["resolution"].get<int>())
          .c_str());
}

int run_plan(const BakeOptions& options, const pipeline::BakeSettings& settings) {
  const auto work = [&](Progress& progress) -> Result<nlohmann::json> {
    LUXEL_TRY(const pipeline::Plan plan, pipeline::plan_bake(settings, progress));
    return to_json(plan);
  };
  return run_and_print(options.common, work, print_plan);
}

int run_bake(const BakeOptions& options) {
  const auto settings = settings_from(options);
  if (!settings) return report(settings.error());
  if (options.plan) return run_plan(options, *settings);
  return run_and_print(
      options.common, [&](Progress& progress) { return pipeline::bake(*settings, progress); },
      [&](const nlohmann::json& json) { print_summary(*settings, json); });
}

}  // namespace

void register_bake(CLI::App& app, Action& action) {
  CLI::App* bake = app.add_subcommand("bake", "Bake a scene's light into lightmaps");
  auto options = std::make_shared<BakeOptions>();
  pipeline::BakeSettings& s = options->settings;
  bake->add_option("SCENE", s.scene, "glTF, OBJ, FBX, ... file")->required();
  bake->add_option("-o,--output", s.output, "Folder for the results; made when missing")
      ->required();
  bake->add_option("--solver", s.solver, "How light is computed: " + pipeline::solver_names())
      ->capture_default_str();
  bake->add_option("--resolution", s.resolution, "Side of a lightmap in texels")
      ->capture_default_str();
  bake->add_option("--texels-per-metre", s.texels_per_metre,
                   "Density; the side becomes the smallest power of two that holds the scene");
  bake->add_option("--pages", options->pages,
                   "Number of lightmaps; auto: as many as the density needs; mesh: one per mesh")
      ->capture_default_str();
  add_uv(*bake, options->uv);
  bake->add_option("--samples", s.samples, "Indirect rays per texel; reference: paths")
      ->capture_default_str();
  bake->add_option("--direct-samples", s.direct_samples,
                   "Shadow rays per texel towards area lights")
      ->capture_default_str();
  bake->add_option("--supersample", s.supersample,
                   "Points per texel across which direct light varies; 1: none")
      ->capture_default_str();
  bake->add_option("--bounces", options->bounces, "Reflections to count, or inf")
      ->capture_default_str();
  add_hemicube(*bake, options->hemicube);
  bake->get_option("--max-error")
      ->description(
          "gather: add rays until the 95th percentile of the relative standard error is below "
          "this, e.g. 0.02; hemicube: cut triangles over which interpolation errs by more, 0 cuts "
          "none")
      ->group("OPTIONS");
  bake->add_option("--time-budget", s.time_budget_s,
                   "gather: the lowest error within about this many seconds in total; with "
                   "--max-error until either is reached")
      ->type_name("SECONDS");
  bake->add_flag("--plan", options->plan,
                 "Do not bake: estimate time, memory and rays from a short trial");
  const char* matrix = "Matrix radiosity";
  bake->add_option("--patches", s.matrix.patches,
                   "Approximate number of patches that exchange light")
      ->capture_default_str()
      ->group(matrix);
  bake->add_option("--rays", s.matrix.rays, "Rays per patch that estimate its form factors")
      ->capture_default_str()
      ->group(matrix);
  add_hierarchical(*bake, s.hierarchical);
  bake->add_option("--directional", options->directional,
                   "Also store how irradiance changes with the normal: dominant or sh1");
  bake->add_option("--probes", s.probe_spacing_m,
                   "Also write light probes on a grid of this spacing in metres")
      ->type_name("SPACING");
  bake->add_option("--layers", options->layers,
                   "Also write a lightmap of each light (per-light), or of each group of lights "
                   "whose names differ only by a number at the end (groups)")
      ->type_name("WHICH");
  bake->add_flag("--denoise", s.denoise, "Remove the noise of few samples; edges of shadows stay");
  bake->add_flag(
      "--texels", s.texels,
      "Also write texels.png: how each texel was treated (luxel render --technique texels)");
  bake->add_flag("--error-map", s.error_map,
                 "Also write error.png: the relative standard error of each texel (luxel render "
                 "--technique error)");
  bake->add_flag("!--no-leak-repair", s.repair_leaks,
                 "Do not cut charts under thin walls, nor move samples out of solids");
  bake->add_flag("!--no-stitch", s.stitch, "Do not blend charts along seams");
  bake->add_flag("--vertex-colors", s.vertex_colors,
                 "hemicube: baked.glb gets light per vertex in COLOR_0 instead of the lightmap");
  bake->add_option("--formats", options->formats,
                   "The lightmap as exr (always), hdr, rgbm and rgbe, with commas between them")
      ->capture_default_str();
  bake->add_flag("--html", s.html,
                 "Also write view.html: the baked scene as one page to walk around in");
  bake->add_option("--max-memory", options->max_memory,
                   "Memory to stay under, as 900M or 1.5G (default: most of what is free)");
  bake->add_option("--checkpoint", s.checkpoint_s,
                   "gather: from this many seconds after the start on, keep finished parts in "
                   "FOLDER/checkpoint.luxel until the bake is done; 0: never")
      ->capture_default_str();
  bake->add_flag("--resume", s.resume, "gather: continue from the checkpoint in the folder");
  bake->add_flag("--keep", s.keep,
                 "gather: build on the bake kept in FOLDER/cache and retrace only what has changed "
                 "in the scene since; without one, bake and keep it there");
  bake->add_option("--seed", s.seed, "Seed of all random numbers")->capture_default_str();
  add_outside_light(*bake, options->outside);
  add_common(*bake, options->common);
  bake->callback([options, bake, &action] {
    options->resolution_given = bake->count("--resolution") > 0;
    for (const SolverOption& option : kSolverOptions)
      if (bake->count(option.name) > 0) options->given.insert(option.name);
    action = [options] { return run_bake(*options); };
  });
}

}  // namespace luxel::cli
