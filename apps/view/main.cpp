// The `luxel-view` program: a bake, or a scene while it is baked, in a window, or drawn by a
// graphics device without one.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "apps/view/next_subject.h"
#include "apps/view/offscreen.h"
#include "apps/view/print.h"
#include "apps/view/remembered.h"
#include "apps/view/session.h"
#include "luxel/arguments/bake_options.h"
#include "luxel/arguments/option_file.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/image/codec.h"
#include "luxel/pipeline/command/relight_options.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/view/model/habits.h"
#include "luxel/view/open_bake.h"
#include "luxel/view/relight/kept_lxr.h"

namespace {

using namespace luxel;

constexpr int kDone = 0, kBadInput = 1, kUsage = 2, kOutOfResource = 3;

struct Options {
  std::filesystem::path subject, beside, screenshot, play, frame_table;
  std::vector<std::filesystem::path> more;  ///< models beside the subject
  std::string size, device;
  std::string inside;  ///< a solver's name; empty: a scene is baked
  bool relight = false;
  bool offscreen = false;
  int turn_frames = 0;           ///< of --turntable; 0: one picture
  int width = 0, height = 0;     ///< 0: as preview.png
  arguments::BakeChoice choice;  ///< of a subject that is a scene
  arguments::Given of_lxr;       ///< what a bake has not
};

Status parse_size(Options& options) {
  char rest = 0;
  constexpr int kMost = 16384;
  if (options.size.empty()) return {};
  if (std::sscanf(options.size.c_str(), "%dx%d%c", &options.width, &options.height, &rest) == 2 &&
      options.width > 0 && options.height > 0 && options.width <= kMost && options.height <= kMost)
    return {};
  return fail(ErrorCode::bad_setting,
              "--size '{}' is not WIDTHxHEIGHT, as in 960x720, each up to {}", options.size, kMost);
}

Result<std::optional<view::Play>> events_of(const Options& options) {
  if (options.play.empty()) return std::nullopt;
  LUXEL_TRY(view::Play play, view::read_play(options.play));
  return play;
}

/// A scene, which is to be baked; everything else is an .lxr file or the folder of a bake.
bool is_scene(const std::filesystem::path& subject) {
  std::error_code ignored;
  return !view::is_lxr(subject) && std::filesystem::is_regular_file(subject, ignored);
}

constexpr std::string_view kHierarchical = "hierarchical", kHemicube = "hemicube";

/// Errors: a solver that cannot be looked into, a bake that is there.
Status check_inside(const Options& options) {
  const std::string& solver = options.choice.solver;
  if (options.inside != kHierarchical && options.inside != kHemicube)
    return fail(ErrorCode::bad_setting, "--inside {} is not known; choose from: {}, {}",
                options.inside, kHierarchical, kHemicube);
  if (!is_scene(options.subject))
    return fail(ErrorCode::bad_setting, "--inside needs the file of a scene; {} is not one",
                options.subject.empty() ? "nothing" : options.subject.string());
  if (!solver.empty() && solver != options.inside)
    return fail(ErrorCode::bad_setting, "--solver {} contradicts --inside {}", solver,
                options.inside);
  if (options.choice.given.has("--bounces"))
    return fail(ErrorCode::bad_setting, "--inside {} gathers all bounces; leave --bounces out",
                options.inside);
  if (!options.choice.output.empty())
    return fail(ErrorCode::bad_setting, "--output is for a bake; --inside {} saves nothing",
                options.inside);
  return {};
}

/// Errors: what is no scene, or looked at in another way.
Status check_relight(const Options& options) {
  if (!options.relight && !options.of_lxr.empty())
    return fail(ErrorCode::bad_setting, "{} is for --relight; leave it out, or add --relight",
                options.of_lxr.values[0].first);
  if (!options.relight) return {};
  if (view::is_lxr(options.subject))
    return fail(ErrorCode::bad_setting,
                "{} is already prepared: its lamps move without --relight; leave it out",
                options.subject.string());
  if (!is_scene(options.subject))
    return fail(ErrorCode::bad_setting, "--relight needs the file of a scene; {} is not one",
                options.subject.string());
  if (!options.inside.empty() || !options.choice.solver.empty())
    return fail(ErrorCode::bad_setting, "--relight has its own solver; leave {} out",
                options.inside.empty() ? "--solver" : "--inside");
  return {};
}

/// Errors: options of a bake beside a bake that is there, or a second bake beside none.
Status check_choice(const Options& options) {
  const arguments::BakeChoice& choice = options.choice;
  if (arguments::is_option_file(choice.settings))
    return fail(
        ErrorCode::bad_setting,
        "--settings {} is for luxel bake; luxel-view takes the bake.json of an earlier bake",
        choice.settings.string());
  // Options are for what will be dropped.
  if (options.subject.empty() && options.beside.empty() && options.inside.empty()) return {};
  if (!options.beside.empty() && is_scene(options.subject))
    return fail(ErrorCode::bad_setting,
                "--beside needs a first bake to compare with; {} is not the folder of a bake",
                options.subject.string());
  if (!options.more.empty() && options.inside != kHemicube)
    return fail(ErrorCode::bad_setting, "only --inside {} takes several models; give one model",
                kHemicube);
  if (!options.inside.empty()) LUXEL_TRY_STATUS(check_inside(options));
  LUXEL_TRY_STATUS(check_relight(options));
  if (choice.given.has("--part"))
    return fail(ErrorCode::bad_setting, "a window shows a whole bake; leave --part out");
  std::string flag;
  if (!choice.solver.empty()) flag = "--solver";
  if (!choice.settings.empty()) flag = "--settings";
  if (!choice.output.empty()) flag = "--output";
  if (!choice.given.empty()) flag = choice.given.values[0].first;
  if (is_scene(options.subject) || flag.empty()) return {};
  return fail(ErrorCode::bad_setting, "{} is for a scene to bake; {} is not the file of a scene",
              flag, options.subject.string());
}

/// Options that a bake and --relight understand differently, or that only other solvers have.
bool is_of_lxr(const std::string& flag) {
  return flag == "--patches" || flag == "--rays" || flag == "--max-error";
}

/// Those of `luxel bake`, but that a processor is left to the window, and a folder is chosen.
Result<pipeline::BakeSettings> settings_of(const Options& options) {
  arguments::BakeChoice choice = options.choice;
  choice.scene = options.subject;
  if (options.relight)
    std::erase_if(choice.given.values, [](const auto& given) { return is_of_lxr(given.first); });
  if (!options.inside.empty()) choice.solver = options.inside;
  if (choice.output.empty())
    choice.output = std::filesystem::path("baked") / options.subject.stem();
  LUXEL_TRY(pipeline::BakeSettings settings, arguments::settings_of(choice));
  if (!options.offscreen && !choice.given.has("--threads"))
    settings.threads = std::max(1, int(std::thread::hardware_concurrency()) - 1);
  return settings;
}

/// Those of `luxel relight`: what a bake has, too, is the same for both.
Result<view_window::RelightParams> relight_of(const Options& options,
                                              const pipeline::BakeSettings& bake) {
  view_window::RelightParams out;
  out.begins = options.relight;
  pipeline::RelightSettings& s = out.settings;
  s.scene = bake.scene, s.output = view::lxr_in(bake.output);
  s.resolution = bake.resolution.value_or(s.resolution);
  s.texels_per_metre = bake.texels_per_metre, s.uv = bake.uv, s.bounces = bake.bounces;
  s.max_memory_bytes = bake.max_memory_bytes, s.seed = bake.seed, s.threads = bake.threads;
  if (!options.relight) return out;
  arguments::Given given = options.of_lxr;
  for (const auto& value : options.choice.given.values)
    if (is_of_lxr(value.first)) given.values.push_back(value);
  LUXEL_TRY_STATUS(arguments::read_given(given, pipeline::relight_options(), s));
  return out;
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) view_window::print_line(warning, "warning: ");
}

/// The second bake, if there is one; one camera looks at both.
Result<std::optional<view::OpenedBake>> opened_beside(const Options& options, DVec3 origin) {
  if (options.beside.empty()) return std::nullopt;
  LUXEL_TRY(view::OpenedBake out, view::open_bake(options.beside, origin));
  print_warnings(out.warnings);
  return out;
}

/// All models of one scene.
std::vector<std::filesystem::path> models_of(const Options& options) {
  std::vector<std::filesystem::path> out{options.subject};
  out.insert(out.end(), options.more.begin(), options.more.end());
  return out;
}

/// A subject to show, perhaps with a second bake beside it.
struct Opened {
  view_window::MakeSubject make;
  std::optional<view::OpenedBake> beside;
  int width = 960, height = 720;  ///< of a window, where --size says nothing
};

Result<Opened> opened(const Options& options) {
  Opened out;
  if (options.subject.empty()) {
    out.make = view_window::no_subject();
  } else if (is_scene(options.subject)) {
    LUXEL_TRY(const pipeline::BakeSettings settings, settings_of(options));
    if (options.inside == kHemicube)
      out.make = view_window::hemicube_subject(models_of(options), settings);
    else if (options.inside == kHierarchical)
      out.make = view_window::inside_subject(settings);
    else {
      LUXEL_TRY(const view_window::RelightParams relight, relight_of(options, settings));
      out.make = view_window::live_subject(settings, relight);
    }
  } else if (view::is_lxr(options.subject)) {
    LUXEL_TRY(view::OpenedLxr lxr, view::open_lxr(options.subject));
    out.make = view_window::lamp_subject(std::move(lxr));
  } else {
    LUXEL_TRY(view::OpenedBake bake, view::open_bake(options.subject));
    print_warnings(bake.warnings);
    out.width = bake.width, out.height = bake.height;
    LUXEL_TRY(out.beside, opened_beside(options, bake.scene.origin));
    if (out.beside) bake.first.beside.emplace();
    out.make = view_window::baked_subject(std::move(bake));
  }
  if (options.width > 0) out.width = options.width, out.height = options.height;
  return out;
}

/// The subject that replaces the shown one. A scene is baked with the same options.
Result<view_window::MakeSubject> opened_later(const Options& options,
                                              const std::filesystem::path& path) {
  Options other = options;
  if (view_window::full_path(path) != view_window::full_path(options.subject))
    other.choice.output.clear();
  other.subject = path, other.beside.clear(), other.screenshot.clear();
  other.relight &= is_scene(path);
  LUXEL_TRY(Opened opened_other, opened(other));
  return std::move(opened_other.make);
}

Status show(const Options& options) {
  for (const auto& file : {options.screenshot, options.frame_table})
    if (!file.empty()) LUXEL_TRY_STATUS(check_output_file(file));
  view_window::WindowParams params;
  LUXEL_TRY(params.play, events_of(options));
  params.play_name = options.play.string();
  if (!options.subject.empty()) {
    params.title = view_window::title_of(options.subject);
    params.subject = view_window::full_path(options.subject);
  } else {
    params.title = "luxel-view";
  }
  params.open = [&](const std::filesystem::path& path) { return opened_later(options, path); };
  // A play is the same whatever was done before.
  if (!params.play)
    params.habits = view::habits_file(std::getenv("XDG_STATE_HOME"), std::getenv("HOME"));
  params.device = options.device;
  params.screenshot = options.screenshot, params.frame_table = options.frame_table;
  LUXEL_TRY(Opened to_show, opened(options));
  params.width = to_show.width, params.height = to_show.height;
  const auto last_size = view_window::last_size(params.habits);
  if (last_size && options.width == 0)
    params.width = (*last_size)[0], params.height = (*last_size)[1];
  return view_window::show_in_window(to_show.make, std::move(to_show.beside), params);
}

/// Where a picture of a turn goes: out-000.png, out-001.png, ... beside out.png.
std::filesystem::path picture_file(const Options& options, int number) {
  if (options.turn_frames == 0) return options.screenshot;
  std::filesystem::path out = options.screenshot;
  return out.replace_filename(
      fmt::format("{}-{:03}{}", out.stem().string(), number, out.extension().string()));
}

/// One picture, or those of a turn, without a window.
Status draw_offscreen(const Options& options) {
  LUXEL_TRY_STATUS(check_output_file(options.screenshot));
  view_window::OffscreenParams params;
  params.turn_frames = options.turn_frames;
  LUXEL_TRY(params.play, events_of(options));
  params.play_name = options.play.string();
  params.width = options.width, params.height = options.height;
  gpu::DeviceParams device_params;
  device_params.name = options.device;
  LUXEL_TRY(const std::unique_ptr<gpu::Device> device, gpu::Device::open(device_params));
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(*device));
  LUXEL_TRY(Opened to_draw, opened(options));
  LUXEL_TRY(const std::unique_ptr<view_window::Subject> subject, to_draw.make(commands));
  const auto write = [&](int number, const image::Image8& picture) {
    return write_file_atomically(picture_file(options, number), image::encode_png(picture));
  };
  LUXEL_TRY_STATUS(
      view_window::draw_offscreen(commands, *subject, std::move(to_draw.beside), params, write));
  LUXEL_TRY(const std::string said, subject->end());
  if (!said.empty()) view_window::print_line(said);
  view_window::print_line(fmt::format(
      "wrote {}, drawn by {}", picture_file(options, std::max(options.turn_frames - 1, 0)).string(),
      device->name));
  return {};
}

void print_error(std::string_view sentence) { view_window::print_line(sentence, "luxel-view: "); }

int report(const Error& error) {
  print_error(error.message);
  const bool is_resource = error.code == ErrorCode::out_of_memory ||
                           error.code == ErrorCode::out_of_disk ||
                           error.code == ErrorCode::out_of_time;
  return is_resource ? kOutOfResource : kBadInput;
}

void add_own(CLI::App& app, Options& options) {
  app.add_option("SUBJECT", options.subject,
                 "A scene to bake while you look, with all options of `luxel bake`; the output "
                 "folder of a bake; or an .lxr file, whose lamps you can move; without SUBJECT, "
                 "drop one of them on the window");
  app.add_option("MODELS", options.more, "More models for the same scene, with --inside hemicube");
  app.add_option("-o,--output", options.choice.output,
                 "Folder to which 'save' writes the bake of a scene (default: baked/NAME)")
      ->type_name("FOLDER");
  app.add_option("--beside", options.beside, "Output folder of a second bake to compare with")
      ->type_name("FOLDER");
  app.add_option("--inside", options.inside,
                 "Watch a solver from the inside while it computes the light of a scene: "
                 "hierarchical, hemicube")
      ->type_name("SOLVER");
  app.add_flag("--relight", options.relight,
               "Prepare a scene as `luxel relight` does, and with its options, so that its lamps "
               "move with all bounces");
  auto* screenshot = app.add_option("--screenshot", options.screenshot,
                                    "Picture to write, .png; with a window, at the end of --play");
  auto* offscreen =
      app.add_flag("--offscreen", options.offscreen, "Draw one picture without a window")
          ->needs(screenshot);
  app.add_option("--turntable", options.turn_frames,
                 "Draw a turntable of N pictures: out-000.png and so on, for --screenshot out.png")
      ->check(CLI::Range(1, 999).description(""))
      ->type_name("N")
      ->needs(offscreen);
  auto* play = app.add_option("--play", options.play,
                              "Play the mouse and keys in this .json file, then close the window")
                   ->type_name("FILE");
  app.add_option("--frame-times", options.frame_table,
                 "Table to write, .csv: milliseconds and brightness of each frame of --play")
      ->type_name("FILE")
      ->needs(play)
      ->excludes("--offscreen");
  app.add_option("--size", options.size,
                 "Size of the picture or window (default: that of preview.png)")
      ->type_name("WxH");
  app.add_option("--device", options.device,
                 "Part of the name of the graphics device to use (default: the fastest kind)")
      ->type_name("NAME");
}

/// They are many, and `luxel bake --help` and `luxel relight --help` list them.
void add_hidden_options(CLI::App& app, Options& options) {
  const std::vector<CLI::Option*> before = app.get_options();
  arguments::add_bake_settings(app, options.choice);
  arguments::add_bake_table(app, options.choice.given);
  for (const auto& row : pipeline::relight_options())
    if (row.flag != "--target" && !app.get_option_no_throw(row.flag))
      arguments::add_option(app, row, row.help, "", options.of_lxr);
  for (CLI::Option* option : app.get_options())
    if (std::ranges::find(before, option) == before.end()) option->group("");
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Look at the light of a scene in a window, drawn by the graphics card",
               "luxel-view"};
  app.set_version_flag("--version", std::string("luxel-view ") + pipeline::kVersion);
  add_own(app, options);
  add_hidden_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    print_error(fmt::format("{}; 'luxel-view --help' lists the options", error.what()));
    return kUsage;
  }
  if (options.subject.empty() && (options.offscreen || !options.play.empty())) {
    print_error("--offscreen and --play need a SUBJECT");
    return kUsage;
  }
  if (!options.screenshot.empty() && !options.offscreen && options.play.empty()) {
    print_error("--screenshot needs --offscreen or --play");
    return kUsage;
  }
  if (const Status size = parse_size(options); !size) return report(size.error());
  if (const Status choice = check_choice(options); !choice) return report(choice.error());
  const Status done = options.offscreen ? draw_offscreen(options) : show(options);
  return done ? kDone : report(done.error());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return report({ErrorCode::out_of_memory, "out of memory"});
  } catch (const std::exception& error) {
    print_error(fmt::format("internal error: {}; please report this", error.what()));
    return kBadInput;
  }
}
