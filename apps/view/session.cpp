#include "apps/view/session.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <chrono>
#include <cmath>
#include <span>

#include "apps/view/frame_table.h"
#include "apps/view/parts.h"
#include "apps/view/print.h"
#include "apps/view/session_files.h"
#include "luxel/base/file.h"
#include "luxel/image/codec.h"
#include "luxel/view/model/play.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view_window {

std::vector<KeyLine> key_lines(const Subject& subject) {
  std::vector<KeyLine> out = subject.keys();
  out.insert(out.end(), {{"left button", "turn"},
                         {"other buttons", "pan"},
                         {"wheel", "closer, farther"},
                         {"f1", "this list"},
                         {"f12", "a picture of what is shown, as luxel-view-1.png"}});
  for (const view::KeyHelp& key : view::kKeys) out.push_back({key.key, key.does});
  return out;
}

namespace {

/// The surface under the pointer; none under the panel, or where nobody asks for it.
std::optional<scene::SurfacePoint> pointed_surface(const Ui& ui, const view::ReadScene& read,
                                                   const view::Walk& walk) {
  if (ui.has_pointer() || !view::looks_into_bake(walk.shown.show)) return std::nullopt;
  return view::surface_seen(read.scene, *read.tracer, walk.shown, walk.pointer, walk.width,
                            walk.height);
}

/// Shows the walk in the panel, and applies the user's changes there to the walk.
void exchange(Ui& ui, const view::ShownScene& shown, const Looking& looking, float flip,
              Panel& panel, view::Walk& walk) {
  panel.show = int(walk.shown.show);
  panel.stops = std::log2(walk.shown.exposure / walk.first.exposure);
  fill_panel(walk.shown, shown, looking, pointed_surface(ui, *shown.read, walk), panel.look);
  panel.look.flip = flip;
  panel.parts = parts_panel(walk.shown, shown);
  panel.turns = walk.turns;
  for (size_t i = 0; i < walk.bookmarks.size(); ++i)
    panel.has_bookmark[i] = walk.bookmarks[i].has_value();
  const Panel before = panel;
  ui.lay_out(panel);
  if (panel.show != before.show) walk.shown.show = view::Show(panel.show);
  take_panel(panel.look, before.look, walk.shown);
  take_parts(panel.parts, before.parts, walk.shown);
  walk.turns = panel.turns;
  if (panel.stops != before.stops)
    walk.shown.exposure = walk.first.exposure * std::exp2(panel.stops);
  if (const int view = std::exchange(panel.view, -1); view >= 0)
    walk.shown.camera = shown.read->scene.cameras[size_t(view)];
  if (const int mark = std::exchange(panel.bookmark, -1); mark >= 0)
    view::go_to(*walk.bookmarks[size_t(mark)], walk.first.exposure, walk.shown);
}

/// Events of the user, but for those that are the panel's.
void take_events(Window& window, const Ui& ui, const view::TakeEvent& take) {
  for (const view::Event& event : window.taken()) {
    const bool is_key = std::holds_alternative<view::KeyChanged>(event);
    const auto* button = std::get_if<view::ButtonChanged>(&event);
    const bool is_end = button && !button->is_down;  // a drag ends wherever it does
    if (!is_end && !std::holds_alternative<view::PointerMoved>(event) &&
        (is_key ? ui.has_keys() : ui.has_pointer()))
      continue;
    take(event);
  }
}

/// The panel lays itself out anew for some frames after a change.
constexpr int kFramesToSettle = 3;
/// So often the panel tells how a bake goes on.
constexpr double kReport_s = 0.5;

/// A file that is opened again is looked at as before; from elsewhere if its first view is another
/// one.
void go_on_as(const view::Walk& before, view::Walk& walk) {
  const float stops = before.shown.exposure / before.first.exposure;
  const float exposure = walk.first.exposure * stops;
  view::SubjectHabits known{.path = {},
                            .view = view::LastView{before.first.camera, before.shown.camera},
                            .bookmarks = before.bookmarks,
                            .origin = before.origin};
  known = view::moved_to(walk.origin, std::move(known));
  const scene::Camera camera = view::camera_to_begin(known, walk.first.camera);
  if (camera.world_from_camera == known.view->last.world_from_camera)
    walk.target = before.target + to_float(before.origin - walk.origin);
  walk.shown = before.shown, walk.shown.camera = camera, walk.shown.exposure = exposure;
  walk.bookmarks = known.bookmarks, walk.turns = before.turns;
  if (!walk.first.beside) walk.shown.beside.reset();
}

/// Where looking begins: with the scene that was read.
void begin(const view::ReadScene& read, Session& s) {
  const auto width = int(s.screen.swapchain.width), height = int(s.screen.swapchain.height);
  s.place_seen = view::place_seen_in(read.scene, *read.tracer, width, height);
  if (!s.walk) {
    s.walk =
        view::begin_walk(read.first, scene::world_bounds(read.scene), width, height, s.place_seen);
    s.walk->origin = read.scene.origin;
    begin_as_left(s.remembered, *s.walk);
    if (s.carried) go_on_as(*s.carried, *s.walk);
    s.carried.reset();
  }
  s.walk->width = width, s.walk->height = height;
  s.views.clear();
  for (const scene::Camera& camera : read.scene.cameras)
    s.views.push_back(camera.name.empty() ? "camera" : camera.name);
  s.panel.views = s.views;
}

/// Fits what is drawn with to the window and the scene. False while the window has no size, as when
/// it is hidden.
Result<bool> fit(Session& s) {
  const bool fitted = s.fits && has_size_of(s.window, s.screen.swapchain);
  if (fitted && s.shows_scene) return true;
  const view::ShownScene& shown = s.subject->shown();
  if (fitted) {
    LUXEL_TRY_STATUS(fit_scene(shown.device, s.screen));
  } else {
    LUXEL_TRY(s.fits, fit_window(s.window, shown.device, s.screen));
  }
  s.shows_scene = s.fits;
  if (s.fits && shown.read) begin(*shown.read, s);
  return s.fits;
}

/// Takes what has come from the background. True: something is to be drawn.
Result<bool> follow(Session& s) {
  LUXEL_TRY(const Followed followed, s.subject->follow(*s.screen.commands, s.panel.message));
  if (followed.is_another) {
    s.screen.looking = {}, s.shows_scene = false;
    s.screen.additions = s.subject->additions();
    s.keys = key_lines(*s.subject), s.panel.keys = s.keys;
  }
  if (followed.has_scene && s.fits) begin(*s.subject->shown().read, s);
  if (!followed.has_news && seconds_since(s.last_report) < kReport_s) return false;
  s.last_report = Clock::now();
  return followed.has_news || s.subject->work() == Work::at_work;
}

/// No work is taken any longer, as by a device whose driver has crashed.
void lose_device(Session& s) {
  s.screen.device->vk.vkQueueSubmit2KHR = [](VkQueue, uint32_t, const VkSubmitInfo2*, VkFence) {
    return VK_ERROR_DEVICE_LOST;
  };
}

/// An event goes to the window, to the subject, or else to the walk.
void take(const view::Event& event, Session& s) {
  if (const auto* asked = std::get_if<view::OpenAsked>(&event))
    return open_in_window(asked->path, s);
  if (const auto* changed = std::get_if<view::ScaleChanged>(&event)) {
    s.scale = changed->to;
    return;
  }
  if (std::holds_alternative<view::WindowClosed>(event))
    return glfwSetWindowShouldClose(s.window.get(), GLFW_TRUE);
  if (std::holds_alternative<view::DeviceLost>(event)) return lose_device(s);
  s.walk->selected = s.subject->selected();
  if (!s.subject->take(event, *s.walk)) view::handle(event, s.place_seen, *s.walk);
}

/// Makes missing data that the frame shows of the bake; a message says why it cannot.
void look(Session& s) {
  const Status done =
      prepare_look(*s.screen.commands, s.screen.shaders.overlay, s.panel.look.asks_for_layers,
                   s.walk->shown, s.subject->shown(), s.screen.looking);
  if (!done) s.panel.message = done.error().message;
  if (!s.screen.beside) return;
  // Data that the second bake lacks are left out of its picture; the panel follows the first bake.
  view::Frame frame = s.walk->shown;
  const Status beside = prepare_look(*s.screen.commands, s.screen.shaders.overlay, false, frame,
                                     *s.screen.beside, s.screen.looking_beside);
  if (!beside) s.panel.message = "beside: " + beside.error().message;
}

/// The panel, what the user changes in it, and what is asked for by it and by keys.
void lay_out(Session& s) {
  view::ShownScene& shown = s.subject->shown();
  s.panel.warnings = shown.warnings;
  s.panel.scale = s.scale.value_or(s.window.scale());
  s.subject->fill(s.panel);
  if (s.walk)
    exchange(*s.screen.ui, shown, s.screen.looking, s.screen.flip, s.panel, *s.walk);
  else
    s.screen.ui->lay_out(s.panel);
  s.subject->take(s.panel, s.walk ? &*s.walk : nullptr);
  if (!s.walk) return;
  for (const view::Command command : std::exchange(s.walk->asked, {})) s.subject->obey(command);
}

/// The frame to draw; before there is a scene, an empty one.
Result<view::Frame> frame_of(Session& s) {
  if (s.walk) return frame_of(*s.screen.commands, *s.walk, *s.subject);
  view::Frame nothing;
  nothing.show = view::Show::colour;
  return nothing;
}

/// The events of a play up to this frame, and the time until the next. False: it has come to its
/// end.
bool play_on(Session& s) {
  if (s.subject->work() == Work::failed) return false;
  if (!s.walk) return true;
  const view::Play& play = *s.params.play;
  const view::Step step = view::step(
      play, is_at_work(*s.subject) || is_opening(s),
      [&](const view::Event& event) { take(event, s); }, s.played);
  s.play_waits = step == view::Step::waits;
  if (step == view::Step::next) view::pass(1 / play.frames_per_s, *s.walk);
  return step != view::Step::ends;
}

/// The histogram of the frame that was just drawn, where the panel shows it. Colours that stand for
/// something have none.
Status count_pixels(const view::Frame& frame, Session& s) {
  s.screen.looking.histogram.reset();
  const bool is_light =
      frame.show == view::Show::light || frame.show == view::Show::light_and_colour;
  if (!s.panel.look.asks_for_histogram || !is_light) return {};
  LUXEL_TRY(const image::Image radiance,
            view::last_radiance(*s.screen.commands, s.screen.painter, frame.exposure));
  s.screen.looking.histogram = view::histogram_of(radiance, frame.exposure);
  return {};
}

/// Draws and takes the time.
Status draw_frame(Session& s) {
  const auto begin = Clock::now();
  LUXEL_TRY(const view::Frame frame, frame_of(s));
  const view::ShownScene& shown = s.subject->shown();
  const auto lit = Clock::now();
  LUXEL_TRY(s.fits, draw(shown.device, frame, s.screen));
  s.subject->has_drawn(float(1000 * seconds_since(lit)));
  s.panel.milliseconds = float(1000 * seconds_since(begin));
  LUXEL_TRY_STATUS(count_pixels(frame, s));
  if (!s.params.frame_table.empty())
    LUXEL_TRY_STATUS(add_row(s.screen, s.panel.milliseconds, *s.subject, s.table));
  if (!s.window.asks_for_screenshot()) return {};
  return write_screenshot(shown.device, frame, s.screen, s.panel.message);
}

/// Longest sleep of a window in which nothing moves [s]. It sees the background's news afterwards.
constexpr double kSleep_s = 0.1, kSleepAtWork_s = 0.01;

/// One frame of the window. False when a play has come to its end.
Result<bool> go_on(Session& s) {
  // A window in which nothing moves is not drawn: the processor is left to the background.
  const bool moves = (s.params.play && !s.play_waits) ||
                     (s.walk && (!s.walk->keys.empty() || s.walk->turns)) ||
                     !view::is_settled(s.subject->shown());
  if (moves)
    glfwPollEvents();
  else
    glfwWaitEventsTimeout(is_at_work(*s.subject) ? kSleepAtWork_s : kSleep_s);
  const bool fitted = s.fits;
  LUXEL_TRY(const bool has_another, follow_files(s));
  LUXEL_TRY(const bool has_news, follow(s));
  LUXEL_TRY(const bool fits, fit(s));
  const double passed = seconds_since(std::exchange(s.last, Clock::now()));
  if (!fits) return true;
  const bool changes = moves || !fitted || has_news || has_another || s.window.has_changed();
  s.still_frames = changes ? 0 : s.still_frames + 1;
  if (s.still_frames > kFramesToSettle) return !s.params.play || play_on(s);
  if (!s.params.play && s.walk) {
    take_events(s.window, *s.screen.ui, [&](const view::Event& event) { take(event, s); });
    view::pass(std::min(passed, 0.1), *s.walk);
  }
  const double faded_s = s.params.play ? 1 / s.params.play->frames_per_s : passed;
  LUXEL_TRY_STATUS(
      pass_light(faded_s, *s.screen.commands, s.walk ? &*s.walk : nullptr, *s.subject));
  const bool goes_on = !s.params.play || play_on(s);
  if (s.window.asks_for_keys()) s.panel.keys_open = !s.panel.keys_open;
  if (s.walk) look(s);
  lay_out(s);
  LUXEL_TRY_STATUS(draw_frame(s));
  return goes_on;
}

/// A play has ended: what it asked for is done, and told. Errors: why there is nothing to see.
Status end_play(Session& s) {
  if (s.subject->work() == Work::failed) {
    LUXEL_TRY_STATUS(follow(s).map([](bool) {}));
    return fail(ErrorCode::bad_input, "{}", s.panel.message);
  }
  LUXEL_TRY(const std::string said, s.subject->end());
  if (!said.empty()) print_line(said);
  return {};
}

/// Until the window is closed or a play has ended.
Status show(Session s) {
  s.panel.title = s.params.title, s.panel.about = s.screen.device->name;
  s.panel.keys = s.keys, s.panel.recent = s.remembered.others;
  s.panel.is_light = s.remembered.is_light, s.panel.message = s.remembered.message;
  s.panel.layout = s.remembered.layout, s.panel.is_empty = s.path.empty();
  Result<bool> goes_on = true;
  while (goes_on && *goes_on && !glfwWindowShouldClose(s.window.get())) goes_on = go_on(s);
  // A device that is lost takes nothing with it that the user has made.
  if (const Status kept = keep_habits(s); !kept) print_line(kept.error().message, "warning: ");
  if (!goes_on) return Failure{goes_on.error()};
  if (s.params.play && !glfwWindowShouldClose(s.window.get())) LUXEL_TRY_STATUS(end_play(s));
  if (!s.params.frame_table.empty()) {
    const std::string csv = csv_of(s.table);
    LUXEL_TRY_STATUS(
        write_file_atomically(s.params.frame_table, std::as_bytes(std::span<const char>(csv))));
  }
  if (s.params.screenshot.empty() || !s.walk) return {};
  LUXEL_TRY(const view::Frame frame, frame_of(s));
  LUXEL_TRY(const image::Image8 picture, picture_of(s.subject->shown().device, frame, s.screen));
  return write_file_atomically(s.params.screenshot, image::encode_png(picture));
}

}  // namespace

Status show_in_window(const MakeSubject& make_subject, std::optional<view::OpenedBake> beside,
                      const WindowParams& params) {
  LUXEL_TRY(const std::unique_ptr<Window> window,
            Window::open(params.title, params.width, params.height));
  LUXEL_TRY(Screen screen, open_screen(*window, params.device));
  LUXEL_TRY(std::unique_ptr<Subject> subject, make_subject(*screen.commands));
  if (params.play) LUXEL_TRY_STATUS(subject->check(*params.play, params.play_name));
  screen.additions = subject->additions();
  std::optional<view::ShownScene> second;
  if (beside) {
    LUXEL_TRY(second, view::bake_shown(*screen.commands, std::move(*beside)));
    screen.beside = &*second;
  }
  return show({*window, screen, std::move(subject), params});
}

}  // namespace luxel::view_window
