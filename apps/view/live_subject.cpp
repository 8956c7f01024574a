// A bake that is being made.
#include "apps/view/bake_lines.h"
#include "apps/view/subject.h"

namespace luxel::view_window {
namespace {

class LiveSubject : public Subject {
 public:
  LiveSubject(std::unique_ptr<view::LiveBake> live, view::ShownScene shown)
      : live_(std::move(live)), shown_(std::move(shown)) {}

  view::ShownScene& shown() override { return shown_; }

  Result<Followed> follow(gpu::Commands& commands, std::string& message) override {
    view::LiveNews news = live_->take();
    Followed out;
    out.has_news = news.read || news.light || news.said;
    out.has_scene = bool(news.read);
    if (!out.has_news) return out;
    LUXEL_TRY(out.is_another, view::take_news(std::move(news), commands, shown_, message));
    return out;
  }

  Work work() const override {
    const view::LiveState state = live_->state();
    if (state == view::LiveState::failed) return Work::failed;
    const bool is_to_come = state == view::LiveState::baked && !shown_.has_last;
    return is_to_come || state == view::LiveState::baking ? Work::at_work : Work::at_rest;
  }

  bool follows_its_file() const override { return true; }

  void obey(view::Command command) override {
    if (command == view::Command::save) live_->save();
    if (command == view::Command::stop_or_go_on)
      live_->pause(live_->state() == view::LiveState::baking);
  }

  void fill(Panel& panel) const override { panel.bake = lines_of(*live_, shown_); }

  void take(const Panel& panel, const view::Walk* walk) override {
    if (walk) live_->look(walk->shown.camera, float(walk->width) / float(walk->height));
    const BakeLines& asked = *panel.bake;
    if (asked.asks_to_stop || asked.asks_to_go_on) obey(view::Command::stop_or_go_on);
    if (asked.asks_to_save) obey(view::Command::save);
  }

  Result<std::string> end() override {
    live_->wait();
    return live_->take().said.value_or("");
  }

 private:
  std::unique_ptr<view::LiveBake> live_;
  view::ShownScene shown_;
};

}  // namespace

MakeSubject live_subject(const pipeline::BakeSettings& settings) {
  auto live = std::make_shared<std::unique_ptr<view::LiveBake>>(view::LiveBake::begin(settings));
  return [live](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::nothing_shown(commands));
    return std::make_unique<LiveSubject>(std::move(*live), std::move(shown));
  };
}

}  // namespace luxel::view_window
