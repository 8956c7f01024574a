// A bake that is being made, and edits of its scene, after which it is made anew.
#include "apps/view/bake_lines.h"
#include "apps/view/edit_session.h"
#include "apps/view/subject.h"

namespace luxel::view_window {
namespace {

class LiveSubject : public Subject {
 public:
  LiveSubject(std::unique_ptr<view::LiveBake> live, view::ShownScene shown,
              const pipeline::BakeSettings& settings)
      : live_(std::move(live)), shown_(std::move(shown)), settings_(settings) {}

  view::ShownScene& shown() override { return shown_; }

  std::vector<KeyLine> keys() const override { return edit_keys(); }
  /// What a play names is looked for when it comes: there is no scene yet.
  Status check(const view::Play& play, const std::string& name) const override {
    return view::check_no_inside(play, name);
  }

  Result<Followed> follow(gpu::Commands& commands, std::string& message) override {
    view::LiveNews news = live_->take();
    Followed out;
    out.has_news = news.read || news.light || news.said;
    out.has_scene = bool(news.read);
    if (out.has_news) {
      LUXEL_TRY(out.is_another, view::take_news(std::move(news), commands, shown_, message));
    }
    if (!edit_ && shown_.read) edit_ = begin_edits(shown_.read, settings_);
    if (!edit_) return out;
    if (out.is_another) has_another(*edit_);
    if (const std::string said = news_of(*edit_); !said.empty())
      message = said, out.has_news = true;
    return out;
  }

  Work work() const override {
    const view::LiveState state = live_->state();
    if (state == view::LiveState::failed) return Work::failed;
    const bool is_to_come = state == view::LiveState::baked && !shown_.has_last;
    return is_to_come || state == view::LiveState::baking ? Work::at_work : Work::at_rest;
  }

  Box3 selected() const override { return edit_ ? view::selected_box(edit_->tools) : Box3(); }
  bool take(const view::Event& event, const view::Walk& walk) override {
    const bool is_taken = edit_ && view::handle_edits(event, walk, edit_->tools);
    follow_edits();
    return is_taken;
  }
  bool follows_its_file() const override { return !edit_ || edit_->tools.desk.changes == 0; }

  void obey(view::Command command) override {
    if (command == view::Command::save_scene && edit_) save_edited(*edit_);
    if (command == view::Command::save) live_->save();
    if (command == view::Command::stop_or_go_on)
      live_->pause(live_->state() == view::LiveState::baking);
  }

  void fill(Panel& panel) const override {
    panel.bake = lines_of(*live_, shown_);
    if (edit_) panel.edit = panel_of(*edit_);
  }

  void take(const Panel& panel, const view::Walk* walk) override {
    if (walk) live_->look(walk->shown.camera, float(walk->width) / float(walk->height));
    const BakeLines& asked = *panel.bake;
    if (asked.asks_to_stop || asked.asks_to_go_on) obey(view::Command::stop_or_go_on);
    if (asked.asks_to_save) obey(view::Command::save);
    if (walk && edit_ && panel.edit) take_changes(*panel.edit, walk->shown.exposure, *edit_);
    follow_edits();
  }

  Status prepare(gpu::Commands&, const view::Walk& walk, view::Frame& frame) override {
    if (edit_) show_edits(walk, shown_, frame, *edit_);
    return {};
  }

  Result<std::string> end() override {
    live_->wait();
    std::string said = live_->take().said.value_or("");
    if (!edit_) return said;
    LUXEL_TRY(const std::string saved, end_edits(*edit_));
    return saved.empty() ? said : said.empty() ? saved : said + "; " + saved;
  }

 private:
  /// The bake begins anew where something was edited.
  void follow_edits() {
    if (!edit_) return;
    const view::EditDesk& desk = edit_->tools.desk;
    if (std::exchange(followed_, desk.changes) == desk.changes) return;
    live_->edit(desk.now);
    shown_.has_last = false;
  }

  std::unique_ptr<view::LiveBake> live_;
  view::ShownScene shown_;
  pipeline::BakeSettings settings_;
  std::optional<EditSession> edit_;  ///< once something was read
  uint64_t followed_ = 0;            ///< the edits that the bake knows, EditDesk::changes
};

}  // namespace

MakeSubject live_subject(const pipeline::BakeSettings& settings) {
  auto live = std::make_shared<std::unique_ptr<view::LiveBake>>(view::LiveBake::begin(settings));
  return [live, settings](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::nothing_shown(commands));
    return std::make_unique<LiveSubject>(std::move(*live), std::move(shown), settings);
  };
}

}  // namespace luxel::view_window
