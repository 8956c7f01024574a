#include "apps/view/offscreen.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "apps/view/looking.h"
#include "luxel/view/draw/beside.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/model/play.h"

namespace luxel::view_window {
namespace {

/// Returns when the background has come to rest and its light is shown. Errors: why there is none.
Status finish_work(gpu::Commands& commands, view::Walk* walk, Subject& subject) {
  std::string message;
  for (;;) {
    LUXEL_TRY_STATUS(subject.follow(commands, message).map([](Followed) {}));
    if (subject.work() == Work::failed) return fail(ErrorCode::bad_input, "{}", message);
    LUXEL_TRY_STATUS(pass_light(view::kFade_s, commands, walk, subject));
    if (!is_at_work(subject)) return {};
    // Making a frame asks the background for the light that it shows.
    if (walk) LUXEL_TRY_STATUS(frame_of(commands, *walk, subject).map([](const view::Frame&) {}));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// Errors: events for a window.
Status check_no_window(const view::Play& play, const std::string& name) {
  for (const view::TimedEvent& timed : play.events)
    if (std::holds_alternative<view::OpenAsked>(timed.event) ||
        std::holds_alternative<view::ScaleChanged>(timed.event) ||
        std::holds_alternative<view::WindowClosed>(timed.event) ||
        std::holds_alternative<view::DeviceLost>(timed.event))
      return fail(ErrorCode::bad_input,
                  "{}: \"open\", \"scale\", \"close\" and \"lose\" are for a window; play it "
                  "without --offscreen",
                  name);
  return {};
}

/// Walks to where a play gets to.
Status play_all(const view::Play& play, gpu::Commands& commands, view::Walk& walk,
                Subject& subject) {
  const auto take = [&](const view::Event& event) {
    // An edit may have put another scene in the place of this one.
    const view::ReadScene& read = *subject.shown().read;
    walk.selected = subject.selected();
    if (!subject.take(event, walk))
      view::handle(event, view::place_seen_in(read.scene, *read.tracer, walk.width, walk.height),
                   walk);
    for (const view::Command command : std::exchange(walk.asked, {})) subject.obey(command);
  };
  view::Played played;
  for (;;) {
    const view::Step step = view::step(play, is_at_work(subject), take, played);
    if (step == view::Step::ends) return {};
    if (step == view::Step::next) view::pass(1 / play.frames_per_s, walk);
    if (step == view::Step::waits) LUXEL_TRY_STATUS(finish_work(commands, &walk, subject));
  }
}

/// Shaders, painter and data that pictures are drawn with.
struct Easel {
  view::Shaders shaders;
  view::Painter painter;
  Looking looking, looking_beside;
  std::optional<view::ShownScene> beside;
  std::optional<view::Pair> pair;
  const view::Additions* additions = nullptr;  ///< of the subject

  view::Canvas canvas(const view::DeviceScene& scene) const {
    return canvas_of(shaders, painter, scene, looking, additions);
  }
  view::Canvas canvas_beside() const {
    return canvas_of(shaders, pair->second, beside->device, looking_beside);
  }
};

/// Makes all that a frame is drawn with. Errors: what the frame shows is not there.
Status set_up(gpu::Commands& commands, view::Frame frame, std::optional<view::OpenedBake> beside,
              const view::Walk& walk, view::ShownScene& shown, Easel& easel) {
  LUXEL_TRY(easel.shaders, view::make_shaders(commands.device()));
  LUXEL_TRY_STATUS(
      prepare_look(commands, easel.shaders.overlay, false, frame, shown, easel.looking));
  if (easel.looking.look)
    if (const auto missing =
            view::missing_for(frame.show, *easel.looking.look, shown.folder.string()))
      return fail(ErrorCode::bad_input, "{}", *missing);
  LUXEL_TRY(easel.painter, view::make_painter(commands.device(), easel.shaders, shown.device,
                                              uint32_t(walk.width), uint32_t(walk.height)));
  if (!beside) return {};
  LUXEL_TRY(easel.beside, view::bake_shown(commands, std::move(*beside)));
  LUXEL_TRY_STATUS(prepare_look(commands, easel.shaders.overlay, false, frame, *easel.beside,
                                easel.looking_beside));
  LUXEL_TRY(easel.pair,
            view::make_pair(commands, easel.shaders, easel.painter, easel.beside->device));
  return {};
}

Result<image::Image8> picture_of(gpu::Commands& commands, const view::Frame& frame,
                                 const view::DeviceScene& scene, const Easel& easel) {
  if (!easel.beside) return view::painted(commands, easel.canvas(scene), frame);
  return view::painted_together(commands, easel.canvas(scene), easel.canvas_beside(), *easel.pair,
                                frame);
}

}  // namespace

Status draw_offscreen(gpu::Commands& commands, Subject& subject,
                      std::optional<view::OpenedBake> beside, const OffscreenParams& params,
                      const TakePicture& take) {
  if (params.play) LUXEL_TRY_STATUS(subject.check(*params.play, params.play_name));
  if (params.play) LUXEL_TRY_STATUS(check_no_window(*params.play, params.play_name));
  LUXEL_TRY_STATUS(finish_work(commands, nullptr, subject));
  const view::ReadScene& read = *subject.shown().read;
  const int width = params.width ? params.width : read.width;
  const int height = params.height ? params.height : read.height;
  const view::PlaceSeen place_seen = view::place_seen_in(read.scene, *read.tracer, width, height);
  view::Frame first = read.first;
  first.exposure = view::exposure(subject.shown().fade);
  if (beside) first.beside.emplace();
  view::Walk walk =
      view::begin_walk(first, scene::world_bounds(read.scene), width, height, place_seen);
  walk.origin = read.scene.origin;
  if (params.play) LUXEL_TRY_STATUS(play_all(*params.play, commands, walk, subject));
  LUXEL_TRY_STATUS(pass_light(0, commands, &walk, subject));
  LUXEL_TRY(view::Frame frame, frame_of(commands, walk, subject));
  // The second time the camera is at rest.
  LUXEL_TRY(frame, frame_of(commands, walk, subject));
  while (is_at_work(subject)) {
    LUXEL_TRY_STATUS(finish_work(commands, &walk, subject));
    LUXEL_TRY(frame, frame_of(commands, walk, subject));
  }
  Easel easel;
  easel.additions = subject.additions();
  LUXEL_TRY_STATUS(set_up(commands, frame, std::move(beside), walk, subject.shown(), easel));
  const view::Walk begun = walk;
  for (int k = 0; k < std::max(params.turn_frames, 1); ++k) {
    if (k > 0) {
      walk.shown.camera = view::turned_camera(begun, k, params.turn_frames);
      LUXEL_TRY(frame, frame_of(commands, walk, subject));
    }
    LUXEL_TRY(const image::Image8 picture,
              picture_of(commands, frame, subject.shown().device, easel));
    LUXEL_TRY_STATUS(take(k, picture));
  }
  return {};
}

}  // namespace luxel::view_window
