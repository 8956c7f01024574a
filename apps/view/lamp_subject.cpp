// An .lxr file, whose lamps move.
#include "apps/view/lamp_session.h"
#include "apps/view/subject.h"

namespace luxel::view_window {
namespace {

class LampSubject : public Subject {
 public:
  LampSubject(LampSession lamps, view::ShownScene shown)
      : lamps_(std::move(lamps)), shown_(std::move(shown)) {}

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

  bool take(const view::Event& event, const view::Walk& walk) override {
    return view::handle_lamps(event, walk, lamps_.desk);
  }
  void fill(Panel& panel) const override { panel.lamps = panel_of(lamps_); }
  void take(const Panel& panel, const view::Walk* walk) override {
    if (walk) take_changes(*panel.lamps, walk->shown.exposure, lamps_);
  }

  Status prepare(gpu::Commands& commands, const view::Walk& walk, view::Frame& frame) override {
    LUXEL_TRY(lit_, light_lamps(commands, shown_.device, lamps_));
    frame.marks = view::marks_of(lamps_.desk, walk);
    return {};
  }
  void has_drawn(float milliseconds) override { add_times(lit_, milliseconds, lamps_); }

 private:
  LampSession lamps_;
  view::ShownScene shown_;
  view::LightTimes lit_;  ///< what the light of the last frame took
};

}  // namespace

MakeSubject lamp_subject(view::OpenedLxr opened) {
  auto kept = std::make_shared<view::OpenedLxr>(std::move(opened));
  return [kept](gpu::Commands& commands) -> Result<std::unique_ptr<Subject>> {
    LUXEL_TRY(view::RelitScene relit, view::lxr_shown(commands, *kept));
    return std::make_unique<LampSubject>(begin_lamps(std::move(*kept), std::move(relit.direct)),
                                         std::move(relit.shown));
  };
}

}  // namespace luxel::view_window
