// A bake that is looked at while it is made: a thread bakes, and hands over what it has by then.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/view/edit/edits.h"
#include "luxel/view/live/live_news.h"

namespace luxel::view {

/// The state of the work.
enum class LiveState : uint8_t { baking, paused, baked, failed };

/// Guards the thread. Its functions are called by one thread and do not wait for the bake, but for
/// the destructor, which ends it within about 0.2 s, and wait().
class LiveBake {
 public:
  /// Begins to bake settings.scene. It must be called from the thread that calls the others.
  static std::unique_ptr<LiveBake> begin(const pipeline::BakeSettings& settings);
  virtual ~LiveBake() = default;

  virtual LiveNews take() = 0;
  /// Light of what this camera sees, in a picture of that aspect (width / height), comes first.
  virtual void look(const scene::Camera& camera, float aspect) = 0;
  virtual LiveState state() const = 0;
  virtual Progress::Snapshot snapshot() const = 0;
  /// Messages of the bake while it goes on: Progress::notes().
  virtual std::vector<std::string> notes() const = 0;
  virtual void pause(bool is_paused) = 0;
  /// While it rests it takes no processor: the bake that goes on ends once there is a draft, and of
  /// an edit only the draft is made. Its light stays as far as it is known, and it is `paused`. The
  /// first edit() after a rest is baked.
  virtual void rest(bool is_resting) = 0;
  /// The scene that was read has become this: a draft of its light comes soon, and then it is baked
  /// anew. Edits that come faster than drafts are made wait, and only the last one is heeded. The
  /// exposure stays. Only once something was read.
  virtual void edit(const SceneNow& now) = 0;
  /// Writes the files of `luxel bake` into settings.output, in the background; take() tells the
  /// end. Only once it is baked.
  virtual void save() = 0;
  /// Returns when all that was asked for has ended, well or not.
  virtual void wait() = 0;
};

}  // namespace luxel::view
