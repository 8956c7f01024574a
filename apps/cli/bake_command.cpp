#include <array>
#include <cstdio>

#include "apps/cli/cli.h"
#include "apps/cli/device_option.h"
#include "luxel/arguments/bake_options.h"
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
};

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
      fmt::format("{} triangles, {} charts, {}{} x {} texels ({} used), {} rays in {:.1f} s{}",
                  counts["triangles"].get<uint64_t>(), counts["charts"].get<uint64_t>(),
                  pages == 1 ? "" : fmt::format("{} pages of up to ", pages),
                  json["atlas"]["resolution"].get<int>(), json["atlas"]["resolution"].get<int>(),
                  counts["texels"].get<uint64_t>(), counts["rays"].get<uint64_t>(),
                  json["seconds"]["total"].get<double>(),
                  json["device"] == "cpu" ? "" : ", with " + json["device"].get<std::string>())
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
  const auto settings = settings_of(options.choice);
  if (!settings) return report(settings.error(), options.common);
  if (options.choice.plan) return run_plan(options, *settings);
  const auto device = open_device(options.device, options.common);
  if (!device) return report(device.error(), options.common);
  const pipeline::BakeDevice* for_bake = *device ? &(*device)->for_pipeline : nullptr;
  return run_and_print(
      options.common,
      [&](Progress& progress) { return pipeline::bake(*settings, progress, for_bake); },
      [&](const nlohmann::json& json) { print_summary(*settings, json); });
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
  add_common(*bake, options->common);
  bake->callback([options, scene, settings, &action] {
    if (scene->count() == 0 && settings->count() == 0) throw CLI::RequiredError("SCENE");
    action = [options] { return run_bake(*options); };
  });
}

}  // namespace luxel::cli
