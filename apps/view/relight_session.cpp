#include "apps/view/relight_session.h"

#include <fmt/format.h>

#include <cmath>

namespace luxel::view_window {
namespace {

void begin(const RelitLive& live, RelightSession& session) {
  session.lamps.reset();
  session.failed.clear();
  session.made_of = live.desk.changes;
  live.bake.rest(true);
  session.maker = view::begin_lxr_maker();
  session.maker->ask({live.desk.read, live.desk.now, session.params.settings});
}

/// The bake begins anew, if it had not come to its end.
void wake(const RelitLive& live) {
  live.bake.rest(false);
  if (live.bake.state() != view::LiveState::baked) live.bake.edit(live.desk.now);
}

/// A stopped preparation ends within some tenths of a second. The window does not wait for it.
void stop(const RelitLive& live, RelightSession& session) {
  session.ending =
      std::async(std::launch::async,
                 [maker = std::shared_ptr(std::move(session.maker))]() mutable { maker.reset(); });
  wake(live);
}

/// True: another subject is shown.
bool take_asked(const RelitLive& live, std::string& message, RelightSession& session) {
  if (!std::exchange(session.asks, false)) return false;
  if (session.maker) {
    stop(live, session);
    message = "preparation was stopped";
    return false;
  }
  if (session.shows_lamps) {
    session.shows_lamps = false;
    message.clear();
    wake(live);
    return true;
  }
  if (session.lamps && session.made_of == live.desk.changes) {
    live.bake.rest(true);
    return session.shows_lamps = true;
  }
  begin(live, session);
  return false;
}

Status show_lamps(gpu::Commands& commands, const RelitLive& live, view::MadeLxr made,
                  std::string& message, RelightSession& session) {
  const std::string file = made.opened.file.string();
  message = made.was_there ? fmt::format("opened {}, which was prepared earlier", file)
                           : fmt::format("prepared {}", file);
  session.told = message;
  LUXEL_TRY(session.lamps, lamp_subject(std::move(made.opened))(commands));
  view::ShownScene& shown = session.lamps->shown();
  shown.warnings = std::move(made.warnings);
  // After an edit the exposure stays, so that a lamp that was dimmed is seen to be darker.
  if (live.desk.changes > 0 && live.shown.has_light)
    shown.fade.exposure_before = shown.fade.exposure_newest = view::exposure(live.shown.fade);
  session.shows_lamps = true;
  return {};
}

}  // namespace

Result<bool> follow_relight(gpu::Commands& commands, const RelitLive& live, std::string& message,
                            RelightSession& session) {
  if (take_asked(live, message, session)) return true;
  if (!session.maker) return false;
  if (session.made_of != live.desk.changes) {
    stop(live, session);
    message = "preparation was stopped because the scene has changed; start it again";
    return false;
  }
  std::vector<Result<view::MadeLxr>> made = session.maker->take();
  if (made.empty()) return false;
  session.maker.reset();
  if (made[0]) {
    LUXEL_TRY_STATUS(show_lamps(commands, live, std::move(*made[0]), message, session));
    return true;
  }
  session.failed = message = made[0].error().message;
  wake(live);
  return false;
}

Status wait_for_relight(RelightSession& session) {
  if (session.maker) {
    session.maker->wait();
    for (const Result<view::MadeLxr>& made : session.maker->take())
      if (!made) session.failed = made.error().message;
    session.maker.reset();
  }
  if (session.failed.empty()) return {};
  return fail(ErrorCode::bad_input, "{}", session.failed);
}

RelightLines lines_of(const RelightSession& session) {
  RelightLines out;
  out.does = session.shows_lamps ? "edit the scene (L)" : "relight (L)";
  if (!session.maker) return out;
  const Progress::Snapshot at = session.maker->snapshot();
  out.does = "stop preparing (L)";
  out.stage = at.stage.empty() ? "preparing" : at.stage;
  if (at.total == 0) return out;
  out.share = float(double(at.done) / double(at.total));
  if (out.share > 0)
    out.left = fmt::format("{:.0f} s left in this stage",
                           std::ceil(at.stage_seconds * (1 / double(out.share) - 1)));
  return out;
}

}  // namespace luxel::view_window
