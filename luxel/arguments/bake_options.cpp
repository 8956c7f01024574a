#include "luxel/arguments/bake_options.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "luxel/arguments/option_file.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::arguments {
namespace {

/// Refuses --resolution with a density, which contradict each other unless pages are automatic.
Status check_resolution(const Given& given, const pipeline::BakeSettings& s) {
  const bool both = given.has("--resolution") && s.texels_per_metre > 0;
  if (!both || s.pages.mode == atlas::PageMode::automatic) return {};
  return fail(ErrorCode::bad_setting,
              "--resolution {} and --texels-per-metre {} contradict each other; leave one out, or "
              "add --pages auto, which takes as many lightmaps of that resolution as it needs",
              s.resolution.value_or(0), s.texels_per_metre);
}

/// A flag's meaning for each solver that looks at it.
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

}  // namespace

CLI::Option* add_bake_settings(CLI::App& command, BakeChoice& choice) {
  CLI::Option* settings =
      command
          .add_option("--settings", choice.settings,
                      "Read scene and settings from the bake.json of an earlier bake, or options "
                      "from a .toml file (default: luxel.toml beside the scene; none: no file); "
                      "the command line overrides the file")
          ->type_name("FILE|none");
  command
      .add_option("--solver", choice.solver,
                  "Solver that computes the light: " + pipeline::solver_names())
      ->type_name("NAME")
      ->default_str(pipeline::BakeSettings{}.solver);
  return settings;
}

void add_bake_table(CLI::App& bake, Given& given) {
  const pipeline::BakeSettings defaults;
  for (const auto& row : pipeline::bake_options())
    if (!bake.get_option_no_throw(row.flag))
      add_option(bake, row, help_of(row.flag), row.default_text(defaults), given);
  for (const auto& row : pipeline::bake_options()) exclude_each_other(bake, row);
}

Result<pipeline::BakeSettings> settings_of(const BakeChoice& options) {
  pipeline::BakeSettings s;
  // Options of an option file came in as arguments.
  const bool reads_bake = !options.settings.empty() && !is_option_file(options.settings);
  if (reads_bake) LUXEL_TRY_STATUS(pipeline::read_settings(options.settings, s));
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
  const bool by_quality = options.given.has("--quality") || !reads_bake;
  if (solver->can.quality && by_quality)
    pipeline::set_quality(
        s.quality == pipeline::Quality::none ? pipeline::Quality::good : s.quality,
        [&](std::string_view flag) { return options.given.has(flag); }, s);
  if (options.plan && !solver->plan)
    return pipeline::not_used("--solver " + s.solver, "--plan", pipeline::solvers_with("--plan"));
  LUXEL_TRY_STATUS(check_resolution(options.given, s));
  return s;
}

}  // namespace luxel::arguments
