// Subjects that are shown, and the user's actions on them besides walking about: a bake, one that
// is being made, lamps that move, a solver that is looked into.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/view/panel.h"
#include "luxel/pipeline/command/relight.h"
#include "luxel/view/draw/painter.h"
#include "luxel/view/live/live_bake.h"
#include "luxel/view/model/walk.h"
#include "luxel/view/relight/relit_scene.h"
#include "luxel/view/shown/shown_scene.h"

namespace luxel::view_window {

/// News from the background.
struct Followed {
  bool has_news = false;    ///< something is to be drawn
  bool has_scene = false;   ///< shown().read is another one
  bool is_another = false;  ///< shown().device is another one, which other things are drawn with
};

/// State of the background.
enum class Work : uint8_t { at_rest, at_work, failed };

/// A window or a picture has one. All of its functions are called by one thread, while nothing
/// draws the scene, and none waits for the background, but for end() and the destructor.
class Subject {
 public:
  virtual ~Subject() = default;

  virtual view::ShownScene& shown() = 0;
  /// Additions drawn besides or instead of its surfaces; null: none.
  virtual const view::Additions* additions() const { return nullptr; }
  /// Keys of its own, for F1.
  virtual std::vector<KeyLine> keys() const { return {}; }
  /// Errors: events of a play that are not for it; `name` is the play's.
  virtual Status check(const view::Play& play, const std::string& name) const;

  /// Takes what has come from the background. `message` gets what is to be told. Errors: no memory
  /// on the device.
  virtual Result<Followed> follow(gpu::Commands&, std::string& /*message*/) { return Followed{}; }
  virtual Work work() const { return Work::at_rest; }
  /// True: its file is opened again as soon as it changes. No work is lost by that, and the user is
  /// at work on the file.
  virtual bool follows_its_file() const { return false; }

  /// The box around what is selected; empty: nothing is.
  virtual Box3 selected() const { return {}; }
  /// True: the subject takes the event, and the walk does not get it.
  virtual bool take(const view::Event&, const view::Walk&) { return false; }
  virtual void obey(view::Command) {}
  /// Its part of the panel, and what the user has changed there. The walk is null until shown()
  /// has a scene.
  virtual void fill(Panel&) const {}
  virtual void take(const Panel&, const view::Walk*) {}

  /// Brings the scene and the frame, which is the walk's so far, to what is to be drawn. Errors: no
  /// memory, the device is lost.
  virtual Status prepare(gpu::Commands&, const view::Walk&, view::Frame&) { return {}; }
  /// A frame in the window took so long.
  virtual void has_drawn(float /*milliseconds*/) {}
  /// Number of edits that the drawn scene has.
  virtual uint64_t edits() const { return 0; }
  /// Times of the stages of the last frame's light.
  virtual view::LightTimes light_times() const { return {}; }

  /// After a play: returns when all that it asked for is done, with what is to be told. Errors:
  /// what could not be done.
  virtual Result<std::string> end() { return std::string(); }
};

/// Makes a subject that lies on a device.
using MakeSubject = std::function<Result<std::unique_ptr<Subject>>(gpu::Commands&)>;

/// Opens a path to show it. Errors: those of files; there is nothing that can be shown.
using OpenSubject = std::function<Result<MakeSubject>(const std::filesystem::path&)>;

/// Nothing, until a file is dropped on the window.
MakeSubject no_subject();
/// A bake that is there.
MakeSubject baked_subject(view::OpenedBake bake);
/// Preparation of a scene whose lamps are to move with all bounces.
struct RelightParams {
  pipeline::RelightSettings settings;
  bool begins = false;  ///< as soon as the scene is read; else when it is asked for
};
/// A bake that is being made; it begins now.
MakeSubject live_subject(const pipeline::BakeSettings& settings, const RelightParams& relight);
/// Hemicube radiosity of one or several models in one scene, and techniques of local illumination
/// to hold it against; it begins now.
MakeSubject hemicube_subject(std::vector<std::filesystem::path> models,
                             const pipeline::BakeSettings& settings);
/// Hierarchical radiosity of a scene, looked into; it begins now.
MakeSubject inside_subject(const pipeline::BakeSettings& settings);
/// An .lxr file, whose lamps move.
MakeSubject lamp_subject(view::OpenedLxr opened);

/// The frame to draw of a subject: colours alone where it has no light.
Result<view::Frame> frame_of(gpu::Commands& commands, const view::Walk& walk, Subject& subject);
/// Light fades in; the exposure goes with it, by as many stops as the user has chosen. `walk` may
/// be null. Errors: no memory on the device.
Status pass_light(double seconds, gpu::Commands& commands, view::Walk* walk, Subject& subject);
/// True while something may still come that a play waits for.
bool is_at_work(Subject& subject);

}  // namespace luxel::view_window
