// A scene that is edited, and what is made of it so that its lamps move with all bounces.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "apps/view/relight_panel.h"
#include "apps/view/subject.h"
#include "luxel/view/relight/lxr_maker.h"

namespace luxel::view_window {

struct RelightSession {
  RelightParams params;
  std::unique_ptr<view::LxrMaker> maker = {};  ///< null: nothing is made
  std::future<void> ending = {};               ///< valid once one was stopped
  std::unique_ptr<Subject> lamps = {};         ///< the last that was made; null: none was
  uint64_t made_of = 0;      ///< view::EditDesk::changes of what is made, or was last
  bool shows_lamps = false;  ///< else the scene is edited
  bool asks = false;         ///< for the other, or to stop making
  std::string told = {};     ///< what is to be told after a play
  std::string failed = {};   ///< why the last could not be made; empty: it could

  bool is_at_work() const { return asks || maker; }
};

/// The scene that it is made of.
struct RelitLive {
  const view::EditDesk& desk;
  view::LiveBake& bake;  ///< rests while lamps are made or moved
  const view::ShownScene& shown;
};

/// Does what is asked for, and takes what was made. True: another subject is shown. `message` gets
/// what is to be told. Errors: no memory on the device.
Result<bool> follow_relight(gpu::Commands& commands, const RelitLive& live, std::string& message,
                            RelightSession& session);
/// Returns when nothing is made any longer. Errors: why it could not be made.
Status wait_for_relight(RelightSession& session);

RelightLines lines_of(const RelightSession& session);

}  // namespace luxel::view_window
