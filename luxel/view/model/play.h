// Plays events, frame by frame.
#pragma once

#include <cstdint>
#include <functional>

#include "luxel/view/model/events.h"

namespace luxel::view {

/// Gets each event when its time has come.
using TakeEvent = std::function<void(const Event&)>;

/// Progress of a play.
struct Played {
  int64_t frame = 0;
  size_t next = 0;  ///< event
};

/// The events that come up to this frame, and then on to the next frame. `is_at_work`: something
/// goes on in the background that an event may wait for; as long as it does, the play stands still.
enum class Step : uint8_t {
  waits,  ///< it stands still
  next,   ///< another frame has begun
  ends,   ///< it has come to its end, and no event is left
};
Step step(const Play& events, bool is_at_work, const TakeEvent& take, Played& played);

/// All of a play that has nothing to wait for. `pass` gets the time between two frames [s].
void play(const Play& events, const TakeEvent& take, const std::function<void(double)>& pass);

}  // namespace luxel::view
