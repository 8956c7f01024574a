// The `luxel-view` program: a bake in a window, or drawn by a graphics device without one.
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>

#include "apps/view/window.h"
#include "luxel/base/file.h"
#include "luxel/base/output_folder.h"
#include "luxel/image/codec.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/trace/ray_tracer.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/open_bake.h"
#include "luxel/view/relight/draw_lxr.h"

namespace {

using namespace luxel;

constexpr int kDone = 0, kBadInput = 1, kUsage = 2, kOutOfResource = 3;

struct Options {
  std::filesystem::path subject, screenshot, play;
  std::string size, device;
  bool offscreen = false;
  int width = 0, height = 0;  ///< 0: as preview.png
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

/// The frame to draw: the first, or where a play gets to.
Result<view::Frame> frame_to_draw(const std::optional<view::Play>& events,
                                  const view::OpenedBake& bake, int width, int height) {
  if (!events) return bake.first;
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(bake.scene));
  const view::PlaceSeen place_seen = view::place_seen_in(bake.scene, tracer, width, height);
  view::Walk walk =
      view::begin_walk(bake.first, scene::world_bounds(bake.scene), width, height, place_seen);
  view::play(*events, place_seen, walk);
  return walk.shown;
}

Result<std::optional<view::Play>> events_of(const Options& options) {
  if (options.play.empty()) return std::nullopt;
  return view::read_play(options.play);
}

void print_warnings(const view::OpenedBake& bake) {
  for (const std::string& warning : bake.warnings)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

Status show(const Options& options) {
  if (!options.screenshot.empty()) LUXEL_TRY_STATUS(check_output_file(options.screenshot));
  view_window::WindowParams params;
  LUXEL_TRY(params.play, events_of(options));
  LUXEL_TRY(const view::OpenedBake bake, view::open_bake(options.subject));
  print_warnings(bake);
  params.title = std::filesystem::absolute(options.subject).lexically_normal().filename().string();
  params.device = options.device;
  params.width = options.width ? options.width : bake.width;
  params.height = options.height ? options.height : bake.height;
  params.screenshot = options.screenshot;
  return view_window::show_in_window(bake, params);
}

/// One picture of an .lxr file after what is played.
Result<image::Image8> picture_of_lxr(const Options& options,
                                     const std::optional<view::Play>& events,
                                     gpu::Commands& commands) {
  LUXEL_TRY(const std::unique_ptr<view::OpenedLxr> opened, view::open_lxr(options.subject));
  const int width = options.width ? options.width : view::kLxrWidth;
  const int height = options.height ? options.height : view::kLxrHeight;
  return view::draw_lxr(commands, *opened, events, options.play.string(), width, height);
}

/// One picture of a bake after what is played.
Result<image::Image8> picture_of_bake(const Options& options,
                                      const std::optional<view::Play>& events,
                                      gpu::Commands& commands) {
  LUXEL_TRY(const view::OpenedBake bake, view::open_bake(options.subject));
  print_warnings(bake);
  const int width = options.width ? options.width : bake.width;
  const int height = options.height ? options.height : bake.height;
  LUXEL_TRY(const view::Frame frame, frame_to_draw(events, bake, width, height));
  LUXEL_TRY(const view::DeviceScene scene,
            view::put_on_device(commands, bake.scene, bake.lightmaps));
  LUXEL_TRY(const view::Shaders shaders, view::make_shaders(commands.device()));
  LUXEL_TRY(const view::Painter painter, view::make_painter(commands.device(), shaders, scene,
                                                            uint32_t(width), uint32_t(height)));
  return view::painted(commands, {shaders, painter, scene}, frame);
}

/// One picture without a window.
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

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Look at a bake in a window, drawn by the graphics card", "luxel-view"};
  app.set_version_flag("--version", std::string("luxel-view ") + pipeline::kVersion);
  app.add_option("FOLDER", options.subject, "What `luxel bake` left")->required();
  auto* screenshot = app.add_option("--screenshot", options.screenshot,
                                    "The picture to write: .png; of a window at the end of --play");
  app.add_flag("--offscreen", options.offscreen, "Draw one picture, without a window")
      ->needs(screenshot);
  app.add_option("--play", options.play, "Mouse and keys to play: .json; then the window closes")
      ->type_name("FILE");
  app.add_option("--size", options.size, "Size of the picture or window (that of preview.png)")
      ->type_name("WxH");
  app.add_option("--device", options.device,
                 "A part of the graphics device's name (the fastest kind)")
      ->type_name("NAME");
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
