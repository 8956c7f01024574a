// The `luxel-view` program: a bake, or a scene while it is baked, in a window, or drawn by a
// graphics device without one.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "apps/view/looking.h"
#include "apps/view/session.h"
#include "luxel/arguments/bake_options.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/image/codec.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/view/draw/beside.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/model/habits.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/open_bake.h"
#include "luxel/view/relight/draw_lxr.h"
#include "luxel/view/shown/shown_scene.h"

namespace {

using namespace luxel;

constexpr int kDone = 0, kBadInput = 1, kUsage = 2, kOutOfResource = 3;

struct Options {
  std::filesystem::path subject, beside, screenshot, play, frame_table;
  std::string size, device;
  bool offscreen = false;
  int width = 0, height = 0;     ///< 0: as preview.png
  arguments::BakeChoice choice;  ///< of a subject that is a scene
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
  if (!view::is_lxr(options.subject))
    LUXEL_TRY_STATUS(view::check_no_lamps(play, options.play.string()));
  return play;
}

/// A scene, which is to be baked; everything else is an .lxr file or the folder of a bake.
bool is_scene(const std::filesystem::path& subject) {
  std::error_code ignored;
  return !view::is_lxr(subject) && std::filesystem::is_regular_file(subject, ignored);
}

/// Errors: options of a bake beside a bake that is there, or a second bake beside none.
Status check_choice(const Options& options) {
  const arguments::BakeChoice& choice = options.choice;
  if (!options.beside.empty() && is_scene(options.subject))
    return fail(ErrorCode::bad_setting,
                "--beside shows a second bake beside a first one; {} is no folder of a bake",
                options.subject.string());
  std::string flag;
  if (!choice.solver.empty()) flag = "--solver";
  if (!choice.settings.empty()) flag = "--settings";
  if (!choice.output.empty()) flag = "--output";
  if (!choice.given.empty()) flag = choice.given.values[0].first;
  if (is_scene(options.subject) || flag.empty()) return {};
  return fail(ErrorCode::bad_setting, "{} is for a scene that is to be baked; {} is no such file",
              flag, options.subject.string());
}

/// Those of `luxel bake`, but that a processor is left to the window, and a folder is chosen.
Result<pipeline::BakeSettings> settings_of(const Options& options) {
  arguments::BakeChoice choice = options.choice;
  choice.scene = options.subject;
  if (choice.output.empty())
    choice.output = std::filesystem::path("baked") / options.subject.stem();
  LUXEL_TRY(pipeline::BakeSettings settings, arguments::settings_of(choice));
  if (!options.offscreen && !choice.given.has("--threads"))
    settings.threads = std::max(1, int(std::thread::hardware_concurrency()) - 1);
  return settings;
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

/// The second bake, if there is one.
Result<std::optional<view::OpenedBake>> opened_beside(const Options& options) {
  if (options.beside.empty()) return std::nullopt;
  LUXEL_TRY(view::OpenedBake out, view::open_bake(options.beside));
  print_warnings(out.warnings);
  return out;
}

Status show(const Options& options) {
  for (const auto& file : {options.screenshot, options.frame_table})
    if (!file.empty()) LUXEL_TRY_STATUS(check_output_file(file));
  view_window::WindowParams params;
  LUXEL_TRY(params.play, events_of(options));
  params.play_name = options.play.string();
  params.title = std::filesystem::absolute(options.subject).lexically_normal().filename().string();
  std::error_code ignored;
  params.subject =
      std::filesystem::weakly_canonical(std::filesystem::absolute(options.subject), ignored)
          .string();
  // A play is the same whatever was done before.
  if (!params.play)
    params.habits = view::habits_file(std::getenv("XDG_STATE_HOME"), std::getenv("HOME"));
  params.device = options.device;
  params.screenshot = options.screenshot, params.frame_table = options.frame_table;
  if (options.width > 0) params.width = options.width, params.height = options.height;
  if (is_scene(options.subject)) {
    LUXEL_TRY(const pipeline::BakeSettings settings, settings_of(options));
    return view_window::bake_in_window(settings, params);
  }
  if (view::is_lxr(options.subject)) {
    LUXEL_TRY(view::OpenedLxr opened, view::open_lxr(options.subject));
    return view_window::relight_in_window(std::move(opened), params);
  }
  LUXEL_TRY(view::OpenedBake bake, view::open_bake(options.subject));
  print_warnings(bake.warnings);
  if (options.width == 0) params.width = bake.width, params.height = bake.height;
  LUXEL_TRY(std::optional<view::OpenedBake> beside, opened_beside(options));
  return view_window::show_in_window(std::move(bake), std::move(beside), params);
}

/// What is to be drawn without a window: a bake that is there, or one that is made first.
Result<view::ShownScene> shown_offscreen(const Options& options, gpu::Commands& commands) {
  if (!is_scene(options.subject)) {
    LUXEL_TRY(view::OpenedBake bake, view::open_bake(options.subject));
    print_warnings(bake.warnings);
    return view::bake_shown(commands, std::move(bake));
  }
  LUXEL_TRY(const pipeline::BakeSettings settings, settings_of(options));
  const std::unique_ptr<view::LiveBake> live = view::LiveBake::begin(settings);
  live->wait();
  view::LiveNews news = live->take();
  if (live->state() == view::LiveState::failed)
    return fail(ErrorCode::bad_input, "{}", news.said.value_or("the bake failed"));
  view::ShownScene out;
  std::string said;
  LUXEL_TRY_STATUS(view::take_news(std::move(news), commands, out, said).map([](bool) {}));
  LUXEL_TRY_STATUS(view::settle(commands, out));
  return out;
}

/// One picture of an .lxr file after what is played.
Result<image::Image8> picture_of_lxr(const Options& options,
                                     const std::optional<view::Play>& events,
                                     gpu::Commands& commands) {
  LUXEL_TRY(view::OpenedLxr opened, view::open_lxr(options.subject));
  return view::draw_lxr(commands, opened,
                        {options.width, options.height, events, options.play.string()});
}

/// The frame to draw: the first, or where a play gets to.
view::Frame frame_to_draw(const std::optional<view::Play>& events, const view::ShownScene& shown,
                          bool has_beside, int width, int height) {
  const view::ReadScene& read = *shown.read;
  view::Frame first = read.first;
  first.exposure = view::exposure(shown.fade);
  if (has_beside) first.beside.emplace();
  if (!events) return first;
  const view::PlaceSeen place_seen = view::place_seen_in(read.scene, *read.tracer, width, height);
  view::Walk walk =
      view::begin_walk(first, scene::world_bounds(read.scene), width, height, place_seen);
  view::play(*events, place_seen, walk);
  return walk.shown;
}

/// A frame of the scene and of the second bake.
Result<image::Image8> painted_beside(const Options& options, gpu::Commands& commands,
                                     const view::Canvas& first, view::Frame frame) {
  LUXEL_TRY(std::optional<view::OpenedBake> opened, opened_beside(options));
  LUXEL_TRY(view::ShownScene shown, view::bake_shown(commands, std::move(*opened)));
  view_window::Looking looking;
  LUXEL_TRY_STATUS(
      view_window::prepare_look(commands, first.shaders.overlay, false, frame, shown, looking));
  LUXEL_TRY(const view::Pair pair,
            view::make_pair(commands, first.shaders, first.painter, shown.device));
  const view::Canvas second{first.shaders, pair.second, shown.device,
                            looking.overlay ? &*looking.overlay : nullptr};
  return view::painted_together(commands, first, second, pair, frame);
}

/// One picture of a bake after what is played.
Result<image::Image8> picture_of_bake(const Options& options,
                                      const std::optional<view::Play>& events,
                                      gpu::Commands& commands) {
  LUXEL_TRY(view::ShownScene shown, shown_offscreen(options, commands));
  const int width = options.width ? options.width : shown.read->width;
  const int height = options.height ? options.height : shown.read->height;
  view::Frame frame = frame_to_draw(events, shown, !options.beside.empty(), width, height);
  LUXEL_TRY(const view::Shaders shaders, view::make_shaders(commands.device()));
  view_window::Looking looking;
  LUXEL_TRY_STATUS(
      view_window::prepare_look(commands, shaders.overlay, false, frame, shown, looking));
  if (looking.look)
    if (const auto missing = view::missing_for(frame.show, *looking.look, shown.folder.string()))
      return fail(ErrorCode::bad_input, "{}", *missing);
  const view::DeviceScene& scene = shown.device;
  LUXEL_TRY(const view::Painter painter, view::make_painter(commands.device(), shaders, scene,
                                                            uint32_t(width), uint32_t(height)));
  const view::Canvas canvas{shaders, painter, scene, looking.overlay ? &*looking.overlay : nullptr};
  return frame.beside ? painted_beside(options, commands, canvas, frame)
                      : view::painted(commands, canvas, frame);
}

/// One picture, without a window.
Status draw_offscreen(const Options& options) {
  LUXEL_TRY_STATUS(check_output_file(options.screenshot));
  LUXEL_TRY(const std::optional<view::Play> events, events_of(options));
  gpu::DeviceParams params;
  params.name = options.device;
  LUXEL_TRY(const std::unique_ptr<gpu::Device> device, gpu::Device::open(params));
  LUXEL_TRY(gpu::Commands commands, gpu::Commands::make(*device));
  LUXEL_TRY(const image::Image8 picture, view::is_lxr(options.subject)
                                             ? picture_of_lxr(options, events, commands)
                                             : picture_of_bake(options, events, commands));
  LUXEL_TRY_STATUS(write_file_atomically(options.screenshot, image::encode_png(picture)));
  std::fprintf(stderr, "wrote %s, drawn by %s\n", options.screenshot.string().c_str(),
               device->name.c_str());
  return {};
}

int report(const Error& error) {
  std::fprintf(stderr, "luxel-view: %s\n", error.message.c_str());
  const bool is_resource = error.code == ErrorCode::out_of_memory ||
                           error.code == ErrorCode::out_of_disk ||
                           error.code == ErrorCode::out_of_time;
  return is_resource ? kOutOfResource : kBadInput;
}

void add_own(CLI::App& app, Options& options) {
  app.add_option("SUBJECT", options.subject,
                 "A scene, which is baked while you look, with all options of `luxel bake`; the "
                 "folder that a bake left; or an .lxr file, whose lamps move")
      ->required();
  app.add_option("-o,--output", options.choice.output,
                 "Where 'save' puts the bake of a scene (baked/NAME)")
      ->type_name("FOLDER");
  app.add_option("--beside", options.beside, "The folder of a second bake, to be compared")
      ->type_name("FOLDER");
  auto* screenshot = app.add_option("--screenshot", options.screenshot,
                                    "The picture to write: .png; of a window at the end of --play");
  app.add_flag("--offscreen", options.offscreen, "Draw one picture, without a window")
      ->needs(screenshot);
  auto* play = app.add_option("--play", options.play,
                              "Mouse and keys to play: .json; then the window closes")
                   ->type_name("FILE");
  app.add_option("--frame-times", options.frame_table,
                 "Milliseconds and brightness of each frame of --play: .csv")
      ->type_name("FILE")
      ->needs(play)
      ->excludes("--offscreen");
  app.add_option("--size", options.size, "Size of the picture or window (that of preview.png)")
      ->type_name("WxH");
  app.add_option("--device", options.device,
                 "A part of the graphics device's name (the fastest kind)")
      ->type_name("NAME");
}

/// They are many, and `luxel bake --help` lists them.
void add_hidden_bake_options(CLI::App& app, arguments::BakeChoice& choice) {
  const std::vector<CLI::Option*> before = app.get_options();
  arguments::add_bake_settings(app, choice);
  arguments::add_bake_table(app, choice.given);
  for (CLI::Option* option : app.get_options())
    if (std::ranges::find(before, option) == before.end()) option->group("");
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Look at light in a window, drawn by the graphics card", "luxel-view"};
  app.set_version_flag("--version", std::string("luxel-view ") + pipeline::kVersion);
  add_own(app, options);
  add_hidden_bake_options(app, options.choice);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "luxel-view: %s; 'luxel-view --help' lists what there is\n", error.what());
    return kUsage;
  }
  if (!options.screenshot.empty() && !options.offscreen && options.play.empty()) {
    std::fprintf(stderr, "luxel-view: --screenshot needs --offscreen or --play\n");
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
    std::fprintf(stderr, "luxel-view: internal error: %s; please report this\n", error.what());
    return kBadInput;
  }
}
