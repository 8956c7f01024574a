#include "apps/cli/bake_summary.h"
#include "apps/cli/cli.h"
#include "apps/cli/device_option.h"
#include "apps/cli/print.h"
#include "apps/cli/together.h"
#include "luxel/arguments/bake_options.h"
#include "luxel/arguments/option_file.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::cli {
namespace {

struct BakeOptions {
  Common common;
  BakeChoice choice;
  std::string device = "cpu";
  int processes_per_node = 1;
};

void print_part(const nlohmann::json& part) {
  const int number = part["number"].get<int>(), of = part["of"].get<int>();
  const auto file = part["file"].get<std::string>();
  print_line(stderr,
             fmt::format("part {} of {}: added {} pieces of work to {}; the next stages need {} "
                         "pieces from other parts; luxel merge finishes the bake",
                         number, of, part["parts_kept"].get<uint64_t>(), file,
                         part["parts_left"].get<uint64_t>()));
}

void print_plan(const nlohmann::json& json) {
  print_line(stderr,
             fmt::format("plan: about {}, {:.0f}M of memory{}, {:.0f} million rays, for {} texels "
                         "on {} x {}; nothing was baked",
                         clock_text(json["seconds"]["total"].get<double>()),
                         json["memory_bytes"].get<double>() / double(1u << 20),
                         json["scratch_bytes"].get<double>() > 0
                             ? fmt::format(" and {:.0f}M of temporary files",
                                           json["scratch_bytes"].get<double>() / double(1u << 20))
                             : std::string(),
                         json["rays"].get<double>() * 1e-6, json["texels"].get<uint64_t>(),
                         json["resolution"].get<int>(), json["resolution"].get<int>()));
}

int run_plan(const BakeOptions& options, const pipeline::BakeSettings& settings) {
  if (!settings.part.is_all())
    return report({ErrorCode::bad_setting, "--plan estimates a whole bake; leave --part out"},
                  options.common);
  const auto work = [&](Progress& progress) -> Result<nlohmann::json> {
    LUXEL_TRY(const pipeline::Plan plan, pipeline::plan_bake(settings, progress));
    return to_json(plan);
  };
  return run_and_print(options.common, work, print_plan);
}

/// `team`: null: this process bakes alone.
int run_bake(const BakeOptions& options, Team* team) {
  const auto settings = settings_of(options.choice);
  if (!settings) return report(settings.error(), options.common);
  if (options.choice.plan) return run_plan(options, *settings);
  const auto device = open_device(options.device, options.common);
  if (!device) return report(device.error(), options.common);
  const pipeline::BakeDevice* for_bake = *device ? &(*device)->for_pipeline : nullptr;
  return run_and_print(
      options.common,
      [&](Progress& progress) { return pipeline::bake(*settings, progress, for_bake, team); },
      [&](const nlohmann::json& json) {
        settings->part.is_all() ? print_bake(*settings, json) : print_part(json["part"]);
      });
}

}  // namespace

void register_bake(CLI::App& app, Action& action) {
  CLI::App* bake = app.add_subcommand("bake", "Bake a scene's light into lightmaps");
  auto options = std::make_shared<BakeOptions>();
  auto* scene = bake->add_option("SCENE", options->choice.scene, "glTF, OBJ, FBX, ... file");
  bake->add_option("-o,--output", options->choice.output, "Output folder; created if missing")
      ->required();
  auto* settings = add_bake_settings(*bake, options->choice);
  auto* plan =
      bake->add_flag("--plan", options->choice.plan,
                     "Estimate time, memory and rays from a short trial, and bake nothing (for " +
                         pipeline::solvers_with("--plan") + ")");
  add_device(*bake, options->device,
             "Where to compute direct light, rays and bounces (gather), hemicubes (hemicube) or "
             "paths (reference)")
      ->excludes(plan);
  add_bake_table(*bake, options->choice.given);
  add_processes_per_node(*bake, options->processes_per_node);
  add_common(*bake, options->common);
  bake->callback([options, scene, settings, &action] {
    const bool has_bake = settings->count() > 0 && !is_option_file(options->choice.settings);
    if (scene->count() == 0 && !has_bake) throw CLI::RequiredError("SCENE");
    action = [options] { return run_together(*options, run_bake); };
  });
}

}  // namespace luxel::cli
