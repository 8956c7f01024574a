#include "apps/view/subject.h"

#include "luxel/view/relight/lamp_desk.h"

namespace luxel::view_window {
namespace {

class ShownSubject : public Subject {
 public:
  explicit ShownSubject(view::ShownScene shown) : shown_(std::move(shown)) {}
  view::ShownScene& shown() override { return shown_; }

 private:
  view::ShownScene shown_;
};

}  // namespace

Status Subject::check(const view::Play& play, const std::string& name) const {
  LUXEL_TRY_STATUS(view::check_no_lamps(play, name));
  return view::check_no_inside(play, name);
}

MakeSubject no_subject() {
  return [](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::nothing_shown(commands));
    return std::make_unique<ShownSubject>(std::move(shown));
  };
}

MakeSubject baked_subject(view::OpenedBake bake) {
  auto kept = std::make_shared<view::OpenedBake>(std::move(bake));
  return [kept](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::bake_shown(commands, std::move(*kept)));
    return std::make_unique<ShownSubject>(std::move(shown));
  };
}

Result<view::Frame> frame_of(gpu::Commands& commands, const view::Walk& walk, Subject& subject) {
  view::Frame out = walk.shown;
  if (!subject.shown().has_light) out.show = view::Show::colour, out.exposure = 1;
  LUXEL_TRY_STATUS(subject.prepare(commands, walk, out));
  return out;
}

Status pass_light(double seconds, gpu::Commands& commands, view::Walk* walk, Subject& subject) {
  view::ShownScene& shown = subject.shown();
  LUXEL_TRY_STATUS(view::pass(seconds, commands, shown));
  if (!walk || !shown.has_light) return {};
  const float stops = walk->shown.exposure / walk->first.exposure;
  walk->first.exposure = view::exposure(shown.fade);
  walk->shown.exposure = walk->first.exposure * stops;
  return {};
}

bool is_at_work(Subject& subject) {
  return subject.work() == Work::at_work || !view::is_settled(subject.shown());
}

}  // namespace luxel::view_window
