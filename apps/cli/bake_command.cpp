#include <cstdio>

#include "apps/cli/bake_summary.h"
#include "apps/cli/cli.h"
#include "apps/cli/device_option.h"
#include "luxel/arguments/bake_options.h"
#include "luxel/cluster/mpi.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/settings/quality.h"
#include "luxel/pipeline/settings/version.h"
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

/// "8 processes on 2 nodes: 2 work, the others lend them their cores".
std::string about_processes(const cluster::Joined& joined) {
  const int working = joined.team ? int(joined.team->size()) : 1;
  const std::string all = fmt::format("{} processes on {} node{}", joined.processes, joined.nodes,
                                      joined.nodes == 1 ? "" : "s");
  if (working == joined.processes) return all + " work together";
  return fmt::format("{}: {} work{}, the others lend their cores (--processes-per-node)", all,
                     working, working == 1 ? "s" : "");
}

void print_part(const nlohmann::json& part) {
  const int number = part["number"].get<int>(), of = part["of"].get<int>();
  const auto file = part["file"].get<std::string>();
  std::fprintf(
      stderr, "%s\n",
      fmt::format("part {} of {}: {} pieces of work were added to {}; the next stages need {} of "
                  "other parts; luxel merge ends the bake",
                  number, of, part["parts_kept"].get<uint64_t>(), file,
                  part["parts_left"].get<uint64_t>())
          .c_str());
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
  if (!settings.part.is_all())
    return report({ErrorCode::bad_setting, "--plan is for a whole bake; leave --part out"},
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

/// A bake of processes that mpirun or srun has started together.
int run_together(BakeOptions options) {
  auto joined = cluster::join_processes(std::string("luxel ") + pipeline::kVersion,
                                        options.processes_per_node);
  if (!joined) return report(joined.error(), options.common);
  const bool is_first = joined->works && (!joined->team || joined->team->rank() == 0);
  if (is_first && !options.common.quiet)
    std::fprintf(stderr, "%s\n", about_processes(*joined).c_str());
  options.common.in_team = true;
  // One of them speaks for all.
  if (!is_first)
    options.common = {.threads = options.common.threads, .quiet = true, .silent = true};
  const int code = joined->works ? run_bake(options, joined->team.get()) : kDone;
  cluster::leave_processes(std::move(*joined), code != kDone);
  return code;
}

}  // namespace

void register_bake(CLI::App& app, Action& action) {
  CLI::App* bake = app.add_subcommand("bake", "Bake a scene's light into lightmaps");
  auto options = std::make_shared<BakeOptions>();
  auto* scene = bake->add_option("SCENE", options->choice.scene, "glTF, OBJ, FBX, ... file");
  bake->add_option("-o,--output", options->choice.output,
                   "Folder for the results; made when missing")
      ->required();
  auto* settings = add_bake_settings(*bake, options->choice);
  auto* plan =
      bake->add_flag("--plan", options->choice.plan,
                     "Do not bake: estimate time, memory and rays from a short trial (for " +
                         pipeline::solvers_with("--plan") + ")");
  add_device(*bake, options->device,
             "What works out gather's direct light, traces its rays, and adds up what "
             "rays bring; with --solver hemicube, what looks through hemicubes; with --solver "
             "reference, what follows paths")
      ->excludes(plan);
  add_bake_table(*bake, options->choice.given);
  bake->add_option("--processes-per-node", options->processes_per_node,
                   "Under mpirun or srun: how many processes of each node work, each with a scene "
                   "of its own; the others lend them their cores")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_common(*bake, options->common);
  bake->callback([options, scene, settings, &action] {
    if (scene->count() == 0 && settings->count() == 0) throw CLI::RequiredError("SCENE");
    action = [options] {
      return cluster::processes_started() > 1 ? run_together(*options)
                                              : run_bake(*options, nullptr);
    };
  });
}

}  // namespace luxel::cli
