// A bake that is being made, and edits of its scene, after which it is made anew; and the same
// scene with lamps that move, once it is prepared for that.
#include "apps/view/bake_lines.h"
#include "apps/view/edit_session.h"
#include "apps/view/relight_session.h"
#include "apps/view/subject.h"
#include "luxel/view/shown/drawn_lamps.h"

namespace luxel::view_window {
namespace {

bool is_relight_key(const view::Event& event) {
  const auto* key = std::get_if<view::KeyChanged>(&event);
  return key && key->is_down && key->key == "l";
}

/// Sentences, those that are there.
std::string together(const std::vector<std::string>& said) {
  std::string out;
  for (const std::string& sentence : said)
    if (!sentence.empty()) out += (out.empty() ? "" : "; ") + sentence;
  return out;
}

class LiveSubject : public Subject {
 public:
  LiveSubject(std::unique_ptr<view::LiveBake> live, view::ShownScene shown,
              const pipeline::BakeSettings& settings, const RelightParams& relight)
      : live_(std::move(live)), shown_(std::move(shown)), settings_(settings), relight_{relight} {
    relight_.asks = relight.begins;
  }

  view::ShownScene& shown() override { return lamps() ? lamps()->shown() : shown_; }

  std::vector<KeyLine> keys() const override {
    if (!lamps()) return edit_keys();
    std::vector<KeyLine> out = lamps()->keys();
    out.push_back({"l", "edit the scene again"});
    return out;
  }
  /// Names in a play are looked up when their events come: there is no scene yet.
  Status check(const view::Play& play, const std::string& name) const override {
    return view::check_no_inside(play, name);
  }

  Result<Followed> follow(gpu::Commands& commands, std::string& message) override {
    Followed out;
    if (!lamps()) {
      LUXEL_TRY(out, follow_bake(commands, message));
    }
    if (edit_) {
      LUXEL_TRY(const bool is_other,
                follow_relight(commands, {edit_->tools.desk, *live_, shown_}, message, relight_));
      if (is_other) return Followed{true, true, true};
    }
    return lamps() ? lamps()->follow(commands, message) : out;
  }

  Work work() const override {
    if (lamps() && !relight_.is_at_work()) return lamps()->work();
    const view::LiveState state = live_->state();
    if (state == view::LiveState::failed) return Work::failed;
    if (relight_.params.begins && !relight_.failed.empty()) return Work::failed;
    if (relight_.is_at_work()) return Work::at_work;
    const bool is_to_come = state == view::LiveState::baked && !shown_.has_last;
    return is_to_come || state == view::LiveState::baking ? Work::at_work : Work::at_rest;
  }

  Box3 selected() const override {
    if (lamps()) return lamps()->selected();
    return edit_ ? view::selected_box(edit_->tools) : Box3();
  }
  bool take(const view::Event& event, const view::Walk& walk) override {
    if (is_relight_key(event)) return relight_.asks = true;
    if (lamps()) return lamps()->take(event, walk);
    const bool is_taken = edit_ && view::handle_edits(event, walk, edit_->tools);
    follow_edits();
    return is_taken;
  }
  bool follows_its_file() const override {
    return !lamps() && (!edit_ || edit_->tools.desk.changes == 0);
  }

  void obey(view::Command command) override {
    if (lamps()) return lamps()->obey(command);
    if (command == view::Command::save_scene && edit_) save_edited(*edit_);
    if (command == view::Command::save) live_->save();
    if (command == view::Command::stop_or_go_on && !relight_.maker)
      live_->pause(live_->state() == view::LiveState::baking);
  }

  void fill(Panel& panel) const override {
    panel.relight = lines_of(relight_);
    panel.bake.reset(), panel.edit.reset(), panel.lamps.reset();
    if (lamps()) return lamps()->fill(panel);
    panel.bake = lines_of(*live_, shown_);
    if (relight_.maker) panel.bake->can_stop = panel.bake->can_go_on = false;
    if (edit_) panel.edit = panel_of(*edit_);
  }

  void take(const Panel& panel, const view::Walk* walk) override {
    if (panel.relight->asks) relight_.asks = true;
    if (lamps()) return lamps()->take(panel, walk);
    if (walk) live_->look(walk->shown.camera, float(walk->width) / float(walk->height));
    const BakeLines& asked = *panel.bake;
    if (asked.asks_to_stop || asked.asks_to_go_on) obey(view::Command::stop_or_go_on);
    if (asked.asks_to_save) obey(view::Command::save);
    if (walk && edit_ && panel.edit) take_changes(*panel.edit, walk->shown.exposure, *edit_);
    follow_edits();
  }

  Status prepare(gpu::Commands& commands, const view::Walk& walk, view::Frame& frame) override {
    if (lamps()) return lamps()->prepare(commands, walk, frame);
    return edit_ ? prepare_edits(commands, walk, frame) : Status{};
  }
  void has_drawn(float milliseconds) override {
    if (lamps()) lamps()->has_drawn(milliseconds);
  }
  uint64_t edits() const override { return shown_edits_; }
  view::LightTimes light_times() const override {
    return lamps() ? lamps()->light_times() : view::LightTimes{};
  }

  Result<std::string> end() override {
    LUXEL_TRY_STATUS(wait_for_relight(relight_));
    std::vector<std::string> said;
    // A bake that rests or is stopped does not end.
    if (live_->state() != view::LiveState::paused) {
      live_->wait();
      said.push_back(live_->take().said.value_or(""));
    }
    if (edit_) {
      LUXEL_TRY(said.emplace_back(), end_edits(*edit_));
    }
    said.push_back(relight_.told);
    if (relight_.lamps) {
      LUXEL_TRY(said.emplace_back(), relight_.lamps->end());
    }
    return together(said);
  }

 private:
  /// Light straight from lamps follows in the next frame.
  Status prepare_edits(gpu::Commands& commands, const view::Walk& walk, view::Frame& frame) {
    const view::EditDesk& desk = edit_->tools.desk;
    if (std::exchange(shown_edits_, desk.changes) != desk.changes)
      LUXEL_TRY_STATUS(view::leave_out_lamps(commands, shown_));
    LUXEL_TRY_STATUS(view::draw_lamps_or_not(!view::looks_into_bake(frame.show), commands, shown_));
    show_edits(walk, shown_, frame, *edit_);
    const trace::CameraRays eye(walk.shown.camera, walk.width, walk.height);
    return view::draw_lamps(commands, desk.now, eye, shown_, drawn_lamps_);
  }

  /// Null: the scene is edited.
  Subject* lamps() const { return relight_.shows_lamps ? relight_.lamps.get() : nullptr; }

  Result<Followed> follow_bake(gpu::Commands& commands, std::string& message) {
    view::LiveNews news = live_->take();
    Followed out;
    out.has_news = news.read || news.light || news.said || !news.without_lamps.empty();
    out.has_scene = bool(news.read);
    if (out.has_news) {
      LUXEL_TRY(out.is_another, view::take_news(std::move(news), commands, shown_, message));
    }
    if (!edit_ && shown_.read) edit_ = begin_edits(shown_.read, settings_);
    if (!edit_) return out;
    if (out.is_another) has_another(*edit_), drawn_lamps_ = {};
    if (const std::string said = news_of(*edit_); !said.empty())
      message = said, out.has_news = true;
    return out;
  }

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
  uint64_t shown_edits_ = 0;         ///< and those that were drawn
  view::DrawnLamps drawn_lamps_;
  RelightSession relight_;
};

}  // namespace

MakeSubject live_subject(const pipeline::BakeSettings& settings, const RelightParams& relight) {
  auto live = std::make_shared<std::unique_ptr<view::LiveBake>>(view::LiveBake::begin(settings));
  return [live, settings, relight](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::ShownScene shown, view::nothing_shown(commands));
    return std::make_unique<LiveSubject>(std::move(*live), std::move(shown), settings, relight);
  };
}

}  // namespace luxel::view_window
