#include <array>
#include <cstdio>

#include "apps/cli/cli.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::cli {
namespace {

struct BakeOptions {
  Common common;
  std::filesystem::path scene, output, settings;
  std::string solver;
  bool plan = false;
  Given given;
};

/// What one option says must not be said by another that was given, too.
Status check_resolution(const Given& given, const pipeline::BakeSettings& s) {
  const bool both = given.has("--resolution") && s.texels_per_metre > 0;
  if (!both || s.pages.mode == atlas::PageMode::automatic) return {};
  return fail(ErrorCode::bad_setting,
              "--resolution {} and --texels-per-metre {} contradict each other; leave one out, or "
              "add --pages auto, which takes as many lightmaps of that resolution as it needs",
              s.resolution.value_or(0), s.texels_per_metre);
}

/// From the file of --settings, if there is one, and then from the command line. What a solver
/// would not look at must not be given: its user expects something of it.
Result<pipeline::BakeSettings> settings_from(const BakeOptions& options) {
  pipeline::BakeSettings s;
  if (!options.settings.empty()) LUXEL_TRY_STATUS(pipeline::read_settings(options.settings, s));
  if (options.given.has("--ies")) s.outside.ies.clear();  // those given win
  if (!options.scene.empty()) s.scene = options.scene;
  if (!options.solver.empty()) s.solver = options.solver;
  s.output = options.output;
  const pipeline::Solver* solver = pipeline::find_solver(s.solver);
  if (!solver) return s;  // the bake says so
  for (const auto& [flag, text] : options.given.values) {
    LUXEL_TRY(const auto* row, pipeline::option_of(*solver, flag));
    LUXEL_TRY_STATUS(row->read_text(s, text));
  }
  s.samples_given = options.given.has("--samples");
  // A file of settings has its numbers.
  const bool by_quality = options.given.has("--quality") || options.settings.empty();
  if (solver->can.quality && by_quality)
    pipeline::set_quality(
        s.quality == pipeline::Quality::none ? pipeline::Quality::good : s.quality,
        [&](std::string_view flag) { return options.given.has(flag); }, s);
  if (options.plan && !solver->plan)
    return pipeline::not_used("--solver " + s.solver, "--plan", pipeline::solvers_with("--plan"));
  LUXEL_TRY_STATUS(check_resolution(options.given, s));
  return s;
}

/// How far the light is off, as far as the solver knows, and where most.
std::string error_text(const pipeline::BakeSettings& settings, const nlohmann::json& json) {
  const double rms = json["relative_error"].get<double>();
  if (rms <= 0) return {};
  const std::string text = fmt::format("estimated error{}: RMS {:.3g} % of the mean light",
                                       settings.denoise ? " before the denoiser" : "", 100 * rms);
  if (!json.contains("error")) return text;
  const auto& error = json["error"];
  const auto& worst = error["worst"];
  const auto at = worst["position"].get<std::array<double, 3>>();
  return text + fmt::format(
                    "; 95 % of texels err by less than {:.3g} %; largest standard error {:.3g} % "
                    "on '{}' at {:.4g}, {:.4g}, {:.4g}",
                    100 * error["relative_p95"].get<double>(),
                    100 * worst["relative"].get<double>(), worst["node"].get<std::string>(), at[0],
                    at[1], at[2]);
}

void print_summary(const pipeline::BakeSettings& settings, const nlohmann::json& json) {
  const auto& counts = json["counts"];
  const size_t pages = json["atlas"]["pages"].size();
  std::fprintf(
      stderr, "%s\n",
      fmt::format("{} triangles, {} charts, {}{} x {} texels ({} used), {} rays in {:.1f} s",
                  counts["triangles"].get<uint64_t>(), counts["charts"].get<uint64_t>(),
                  pages == 1 ? "" : fmt::format("{} pages of up to ", pages),
                  json["atlas"]["resolution"].get<int>(), json["atlas"]["resolution"].get<int>(),
                  counts["texels"].get<uint64_t>(), counts["rays"].get<uint64_t>(),
                  json["seconds"]["total"].get<double>())
          .c_str());
  if (const std::string error = error_text(settings, json); !error.empty())
    std::fprintf(stderr, "%s\n", error.c_str());
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
  if (!settings) return report(settings.error(), options.common);
  if (options.plan) return run_plan(options, *settings);
  return run_and_print(
      options.common, [&](Progress& progress) { return pipeline::bake(*settings, progress); },
      [&](const nlohmann::json& json) { print_summary(*settings, json); });
}

/// What each solver that looks at a flag makes of it.
std::string help_of(const std::string& flag) {
  std::vector<const pipeline::Option<pipeline::BakeSettings>*> rows;
  for (const auto& row : pipeline::bake_options())
    if (row.flag == flag) rows.push_back(&row);
  std::string help;
  for (const auto* row : rows) {
    const std::string users = !row->solver.empty() ? row->solver
                              : row->needs         ? pipeline::solvers_with(*row)
                                                   : "";
    help += (help.empty() ? "" : "; ") +
            help_with(*row, row->group.empty() || rows.size() > 1 ? users : "");
  }
  for (const pipeline::Solver& solver : pipeline::solvers())
    for (const pipeline::OptionNote& note : solver.notes)
      if (note.flag == flag) help += fmt::format("; {}: {}", solver.name, note.text);
  return help;
}

/// Every flag of the table once, under its first row's heading.
void add_table(CLI::App& bake, Given& given) {
  const pipeline::BakeSettings defaults;
  for (const auto& row : pipeline::bake_options())
    if (!bake.get_option_no_throw(row.flag))
      add_option(bake, row, help_of(row.flag), row.default_text(defaults), given);
  for (const auto& row : pipeline::bake_options()) exclude_each_other(bake, row);
}

}  // namespace

void register_bake(CLI::App& app, Action& action) {
  CLI::App* bake = app.add_subcommand("bake", "Bake a scene's light into lightmaps");
  auto options = std::make_shared<BakeOptions>();
  auto* scene = bake->add_option("SCENE", options->scene, "glTF, OBJ, FBX, ... file");
  bake->add_option("-o,--output", options->output, "Folder for the results; made when missing")
      ->required();
  auto* settings =
      bake->add_option("--settings", options->settings,
                       "Take scene and settings from the bake.json of an earlier bake; options "
                       "given beside it win")
          ->type_name("FILE.json");
  bake->add_option("--solver", options->solver,
                   "How light is computed: " + pipeline::solver_names())
      ->type_name("NAME")
      ->default_str(pipeline::BakeSettings{}.solver);
  bake->add_flag("--plan", options->plan,
                 "Do not bake: estimate time, memory and rays from a short trial (for " +
                     pipeline::solvers_with("--plan") + ")");
  add_table(*bake, options->given);
  add_common(*bake, options->common);
  bake->callback([options, scene, settings, &action] {
    if (scene->count() == 0 && settings->count() == 0) throw CLI::RequiredError("SCENE");
    action = [options] { return run_bake(*options); };
  });
}

}  // namespace luxel::cli
