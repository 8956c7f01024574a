// `luxel relight`: a scene's light transport into one file, and that file played.
#include "apps/cli/cli.h"
#include "apps/cli/print.h"
#include "apps/cli/together.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/command/play.h"
#include "luxel/pipeline/command/relight_options.h"

namespace luxel::cli {
namespace {

struct RelightOptions {
  Common common;
  int processes_per_node = 1;
  Given reading, outside, making;
  std::filesystem::path scene, lxr, script, output;
  std::vector<CLI::Option*> of_making;  ///< options that playing does not look at
};

Result<pipeline::RelightSettings> settings_from(const RelightOptions& options) {
  pipeline::RelightSettings s;
  s.scene = options.scene, s.output = options.output, s.threads = options.common.threads;
  LUXEL_TRY_STATUS(read_given(options.making, pipeline::relight_options(), s));
  LUXEL_TRY_STATUS(read_given(options.reading, pipeline::import_options(), s.reading));
  LUXEL_TRY_STATUS(read_given(options.outside, pipeline::outside_light_options(), s.outside));
  return s;
}

void print_summary(const pipeline::RelightSettings& s, const nlohmann::json& json) {
  print_line(stderr, fmt::format("{} patches, {} places, {:.1f} s; the matrix has {:.2f} MB and "
                                 "loses {:.2f} % of indirect light, seldom more than {:.2f} %",
                                 json["counts"]["patches"].get<uint64_t>(),
                                 json["counts"]["places"].get<uint64_t>(),
                                 json["seconds"]["total"].get<double>(),
                                 1e-6 * json["bytes"]["matrix"].get<double>(),
                                 100 * json["usual_codec_error"].get<double>(),
                                 100 * json["codec_error"].get<double>()));
  const nlohmann::json& error = json["indirect_error"];
  const double own = error["scene_lights"], lamps = error["point_lights"];
  std::string by;
  if (own > 0) by = fmt::format("{:.1f} % of its mean for the scene's lights", 100 * own);
  if (lamps > 0)
    by += fmt::format("{}{:.1f} % of its mean for point lights", own > 0 ? ", " : "", 100 * lamps);
  if (!by.empty())
    print_line(
        stderr,
        fmt::format("indirect light errs by at most {} (root mean square, against paths)", by));
  print_line(stderr, fmt::format("wrote {} ({:.2f} MB)", s.output.string(),
                                 1e-6 * json["bytes"]["file"].get<double>()));
}

/// `team`: null: this process works alone.
int run_making(const RelightOptions& options, Team* team) {
  const auto settings = settings_from(options);
  if (!settings) return report(settings.error(), options.common);
  return run_and_print(
      options.common,
      [&](Progress& progress) { return pipeline::relight(*settings, progress, team); },
      [&](const nlohmann::json& json) { print_summary(*settings, json); });
}

nlohmann::json json_of(const pipeline::Played& played) {
  nlohmann::json frames = nlohmann::json::array();
  for (const pipeline::FrameTimes& f : played.frames)
    frames.push_back({{"time_s", f.time_s},
                      {"direct_ms", f.direct_ms},
                      {"bounces_ms", f.bounces_ms},
                      {"places_ms", f.places_ms},
                      {"update_ms", f.update_ms()},
                      {"draw_ms", f.draw_ms}});
  return {{"width", played.width}, {"height", played.height}, {"frames", frames}};
}

void print_played(const pipeline::PlaySettings& s, const pipeline::Played& played) {
  double update = 0, draw = 0;
  for (const pipeline::FrameTimes& f : played.frames) update += f.update_ms(), draw += f.draw_ms;
  const double count = double(played.frames.size());
  print_line(stderr,
             fmt::format("{} frames: {:.2f} ms to relight and {:.0f} ms to draw, on average",
                         played.frames.size(), update / count, draw / count));
  print_line(stderr, fmt::format("wrote {} to frame-{:04}.png, and {}",
                                 (s.output / "frame-0000.png").string(), played.frames.size() - 1,
                                 (s.output / "frames.csv").string()));
}

int run_playing(const RelightOptions& options) {
  for (const CLI::Option* option : options.of_making)
    if (option->count() > 0)
      return report(Error{ErrorCode::bad_setting,
                          fmt::format("{} is for preparing a scene, not for --play; leave it out",
                                      option->get_name())},
                    options.common);
  if (options.script.empty())
    return report(Error{ErrorCode::bad_setting,
                        "--play needs --script FILE.json, which says how the lights move"},
                  options.common);
  const pipeline::PlaySettings settings{options.lxr, options.script, options.output,
                                        options.common.threads};
  pipeline::Played played;
  const Status done = run_with_progress(options.common, [&](Progress& progress) -> Status {
    LUXEL_TRY(played, pipeline::play(settings, progress));
    return {};
  });
  if (!done) return report(done.error(), options.common);
  if (options.common.json)
    print_json(stdout, json_of(played));
  else if (!options.common.quiet)
    print_played(settings, played);
  return kDone;
}

int run_relight(const RelightOptions& options) {
  if (!options.lxr.empty()) return run_playing(options);
  if (options.scene.empty())
    return report(
        Error{ErrorCode::bad_setting, "give a SCENE to prepare, or --play FILE.lxr to play a file"},
        options.common);
  if (!options.script.empty())
    return report(Error{ErrorCode::bad_setting, "--script is for --play FILE.lxr; leave it out"},
                  options.common);
  return run_together(options, run_making);
}

void add_making(CLI::App& relight, RelightOptions& options) {
  const auto table = pipeline::relight_options();
  options.of_making = add_options(relight, table, pipeline::RelightSettings{}, options.making);
  for (const auto& row : table) exclude_each_other(relight, row);
}

}  // namespace

void register_relight(CLI::App& app, Action& action) {
  CLI::App* relight = app.add_subcommand(
      "relight", "Prepare a scene for moving lights as an .lxr file, or play an .lxr file");
  auto options = std::make_shared<RelightOptions>();
  auto* scene = relight->add_option("SCENE", options->scene, "glTF, OBJ, FBX, ... file to prepare");
  relight
      ->add_option("-o,--output", options->output,
                   ".lxr file to write; with --play: folder for the frames")
      ->required();
  add_making(*relight, *options);
  relight->add_option("--play", options->lxr, "Draw this .lxr file frame by frame")
      ->type_name("FILE.lxr")
      ->excludes(scene);
  relight
      ->add_option("--script", options->script,
                   "Script that moves the lights (docs/method/relight.md)")
      ->type_name("FILE.json");
  for (CLI::Option* option : add_import(*relight, options->reading))
    options->of_making.push_back(option);
  for (CLI::Option* option : add_outside_light(*relight, options->outside))
    options->of_making.push_back(option);
  add_processes_per_node(*relight, options->processes_per_node);
  add_common(*relight, options->common);
  relight->callback([options, &action] { action = [options] { return run_relight(*options); }; });
}

}  // namespace luxel::cli
