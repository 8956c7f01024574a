// An .lxr file, whose lamps move.
#include "apps/view/lamp_session.h"
#include "apps/view/subject.h"
#include "luxel/view/relight/lamp_script.h"

namespace luxel::view_window {
namespace {

class LampSubject : public Subject {
 public:
  LampSubject(LampSession lamps, view::ShownScene shown)
      : lamps_(std::move(lamps)), shown_(std::move(shown)) {
    if (!view::has_light(lamps_.opened.lamps))
      said_ = "There is no light in " + lamps_.opened.file.filename().string() +
              ": add a lamp in the panel.";
  }

  view::ShownScene& shown() override { return shown_; }

  std::vector<KeyLine> keys() const override {
    std::vector<KeyLine> out{{"left button on a lamp", "move it"}};
    for (const view::KeyHelp& key : view::kLampKeys) out.push_back({key.key, key.does});
    return out;
  }
  Status check(const view::Play& play, const std::string& name) const override {
    LUXEL_TRY_STATUS(view::check_no_inside(play, name));
    return view::check_lamps(play, lamps_.opened.lamps, name);
  }

  Result<Followed> follow(gpu::Commands&, std::string& message) override {
    Followed out;
    has_saved();
    out.has_news = take_found() || !said_.empty();
    if (!said_.empty()) message = std::exchange(said_, {});
    return out;
  }
  Work work() const override {
    return lamps_.check || lamps_.saving.valid() ? Work::at_work : Work::at_rest;
  }

  bool take(const view::Event& event, const view::Walk& walk) override {
    const auto* key = std::get_if<view::KeyChanged>(&event);
    if (key && key->is_down && key->key == "ctrl+s") {
      save(walk);
      return true;
    }
    if (key && key->is_down && key->key == "ctrl+shift+s") {
      begin_to_save_lxr(lamps_);
      return true;
    }
    if (key && key->is_down && key->key == "c") begin_or_stop_check(lamps_);
    // A play that began with the scene itself could not be looked through before.
    if (const Status fits = view::check_lamp_event(event, lamps_.desk.lamps); !fits) {
      said_ = fits.error().message, failed_ = fits.error();
      return true;
    }
    return view::handle_lamps(event, walk, lamps_.desk);
  }
  void fill(Panel& panel) const override { panel.lamps = panel_of(lamps_); }
  void take(const Panel& panel, const view::Walk* walk) override {
    if (!walk) return;
    take_changes(*panel.lamps, walk->shown.exposure, lamps_);
    if (panel.lamps->asks_to_save) save(*walk);
    if (panel.lamps->asks_for_lxr) begin_to_save_lxr(lamps_);
    if (panel.lamps->asks_to_check) begin_or_stop_check(lamps_);
  }

  Status prepare(gpu::Commands& commands, const view::Walk& walk, view::Frame& frame) override {
    LUXEL_TRY(lit_, light_lamps(commands, walk, shown_.device, lamps_));
    frame.marks = view::marks_of(lamps_.desk, walk);
    return {};
  }
  void has_drawn(float milliseconds) override { add_times(lit_, milliseconds, lamps_); }
  view::LightTimes light_times() const override { return lit_; }

  Result<std::string> end() override {
    if (lamps_.check) lamps_.check->wait();
    take_found();
    if (lamps_.saving.valid()) lamps_.saving.wait();
    has_saved();
    if (failed_) return Failure{*failed_};
    return said_at_end_;
  }

 private:
  void save(const view::Walk& walk) {
    note(view::write_lamps(lamps_.opened.file,
                           view::script_of(lamps_.desk.lamps, lamps_.opened.lamps, walk),
                           lamps_.opened.read->scene.origin));
  }
  /// Notes the outcome once another .lxr file was written, or could not be.
  void has_saved() {
    const std::optional<Result<std::string>> saved = take_saved(lamps_);
    if (saved) note(*saved);
  }
  void note(const Result<std::string>& saved) {
    said_ = saved ? *saved : saved.error().message;
    if (saved)
      tell(said_);
    else
      failed_ = saved.error();
  }
  bool take_found() {
    const bool has_found = take_check(lamps_);
    if (has_found) tell(lamps_.found);
    return has_found;
  }
  void tell(const std::string& sentence) {
    said_at_end_ += (said_at_end_.empty() ? "" : "; ") + sentence;
  }

  LampSession lamps_;
  view::ShownScene shown_;
  view::LightTimes lit_;     ///< what the light of the last frame took
  std::string said_;         ///< what the panel is yet to tell
  std::string said_at_end_;  ///< what is to be told after a play
  std::optional<Error> failed_;
};

}  // namespace

MakeSubject lamp_subject(view::OpenedLxr opened) {
  auto kept = std::make_shared<view::OpenedLxr>(std::move(opened));
  return [kept](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::RelitScene relit,
              view::lxr_shown(commands, view::patch_light_of(commands.device()), *kept));
    return std::make_unique<LampSubject>(begin_lamps(std::move(*kept), std::move(relit.lamps)),
                                         std::move(relit.shown));
  };
}

}  // namespace luxel::view_window
