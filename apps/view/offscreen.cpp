#include "apps/view/offscreen.h"

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
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// Walks to where a play gets to.
Status play_all(const view::Play& play, const view::PlaceSeen& place_seen, gpu::Commands& commands,
                view::Walk& walk, Subject& subject) {
  const auto take = [&](const view::Event& event) {
    if (!subject.take(event, walk)) view::handle(event, place_seen, walk);
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

/// What one picture is drawn with.
struct Easel {
  view::Shaders shaders;
  view::Painter painter;
  Looking looking, looking_beside;
};

Result<image::Image8> painted_beside(gpu::Commands& commands, view::OpenedBake bake,
                                     const view::Canvas& first, Easel& easel, view::Frame frame) {
  LUXEL_TRY(view::ShownScene shown, view::bake_shown(commands, std::move(bake)));
  LUXEL_TRY_STATUS(
      prepare_look(commands, easel.shaders.overlay, false, frame, shown, easel.looking_beside));
  LUXEL_TRY(const view::Pair pair,
            view::make_pair(commands, first.shaders, first.painter, shown.device));
  const view::Canvas second{
      first.shaders, pair.second, shown.device,
      easel.looking_beside.overlay ? &*easel.looking_beside.overlay : nullptr,
      easel.looking_beside.probes ? &*easel.looking_beside.probes : nullptr};
  return view::painted_together(commands, first, second, pair, frame);
}

Result<image::Image8> picture_of(gpu::Commands& commands, view::Frame frame,
                                 std::optional<view::OpenedBake> beside, const view::Walk& walk,
                                 Subject& subject) {
  view::ShownScene& shown = subject.shown();
  Easel easel;
  LUXEL_TRY(easel.shaders, view::make_shaders(commands.device()));
  LUXEL_TRY_STATUS(
      prepare_look(commands, easel.shaders.overlay, false, frame, shown, easel.looking));
  if (easel.looking.look)
    if (const auto missing =
            view::missing_for(frame.show, *easel.looking.look, shown.folder.string()))
      return fail(ErrorCode::bad_input, "{}", *missing);
  LUXEL_TRY(easel.painter, view::make_painter(commands.device(), easel.shaders, shown.device,
                                              uint32_t(walk.width), uint32_t(walk.height)));
  const view::Canvas canvas{easel.shaders, easel.painter, shown.device,
                            easel.looking.overlay ? &*easel.looking.overlay : nullptr,
                            easel.looking.probes ? &*easel.looking.probes : nullptr};
  if (beside) return painted_beside(commands, std::move(*beside), canvas, easel, frame);
  return view::painted(commands, canvas, frame);
}

}  // namespace

Result<image::Image8> draw_offscreen(gpu::Commands& commands, Subject& subject,
                                     std::optional<view::OpenedBake> beside,
                                     const OffscreenParams& params) {
  if (params.play) LUXEL_TRY_STATUS(subject.check(*params.play, params.play_name));
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
  if (params.play) LUXEL_TRY_STATUS(play_all(*params.play, place_seen, commands, walk, subject));
  LUXEL_TRY(view::Frame frame, frame_of(commands, walk, subject));
  return picture_of(commands, std::move(frame), std::move(beside), walk, subject);
}

}  // namespace luxel::view_window
