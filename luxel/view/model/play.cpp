#include "luxel/view/model/play.h"

#include <cmath>

namespace luxel::view {
namespace {

/// True: the time of the next event has come by this frame.
bool has_come(const Play& events, const Played& played) {
  constexpr double kRounding_s = 1e-9;
  return played.next < events.events.size() &&
         events.events[played.next].at_s <=
             double(played.frame) / events.frames_per_s + kRounding_s;
}

}  // namespace

Step step(const Play& events, bool is_at_work, const TakeEvent& take, Played& played) {
  const bool is_last = played.frame >= std::llround(events.end_s * events.frames_per_s);
  bool has_taken = false;
  // The last frame takes all events that are left.
  while (has_come(events, played) || (is_last && played.next < events.events.size())) {
    const Event& event = events.events[played.next].event;
    if (std::holds_alternative<WaitForBake>(event)) {
      // An event just before may have begun work: the wait begins with the next step.
      if (is_at_work || has_taken) return Step::waits;
    } else {
      take(event), has_taken = true;
    }
    ++played.next;
  }
  if (is_last) return Step::ends;
  ++played.frame;
  return Step::next;
}

void play(const Play& events, const TakeEvent& take, const std::function<void(double)>& pass) {
  Played played;
  for (;;) {
    const Step now = step(events, false, take, played);
    if (now == Step::ends) return;
    if (now == Step::next) pass(1 / events.frames_per_s);
  }
}

}  // namespace luxel::view
