#include "luxel/view/live/live_bake.h"

#include <mutex>

#include <nlohmann/json.hpp>

#include "luxel/base/errands.h"
#include "luxel/base/worker.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/view/live/bake_run.h"

namespace luxel::view {
namespace {

/// The height of the picture whose texels come first; only its shape counts.
constexpr int kViewHeight = 1000;

/// A scene that has become another one.
struct Edit {
  std::optional<SceneNow> now;  ///< none: the file as it is
  uint64_t number = 0;          ///< counts edits
};

/// A bake that has come to its end, and how it went.
struct Baked {
  std::shared_ptr<const pipeline::Bake> bake;
  std::shared_ptr<const Progress> progress;
};

class LiveWorker : public LiveBake {
 public:
  explicit LiveWorker(const pipeline::BakeSettings& settings)
      : settings_(settings),
        saving_([this](const Baked& baked, const Saver::Hand& hand, Progress& progress) {
          return write(baked, hand, progress);
        }),
        baking_([this](Edit edit, const Baker::Hand& hand, Progress& progress) {
          return bake(std::move(edit), hand, progress);
        }) {
    of_edits_.outside = {};  // the scene has it
    baking_.ask({});
  }
  ~LiveWorker() override { ends_.request_cancel(); }

  LiveNews take() override {
    LiveNews out;
    const auto add = [&](std::vector<Result<LiveNews>> come) {
      for (Result<LiveNews>& news : come) {
        if (news)
          merge(std::move(*news), out);
        else
          out.said = news.error().message;
      }
    };
    add(baking_.take()), add(saving_.take());
    return out;
  }
  void look(const scene::Camera& camera, float aspect) override {
    auto eye =
        std::make_shared<const trace::CameraRays>(camera, int(kViewHeight * aspect), kViewHeight);
    const std::scoped_lock lock(mutex_);
    eye_ = std::move(eye);
  }
  LiveState state() const override {
    const std::scoped_lock lock(mutex_);
    if (state_ != LiveState::baking) return state_;
    if (!baking_.is_at_work()) return LiveState::failed;
    return is_paused_ ? LiveState::paused : LiveState::baking;
  }
  Progress::Snapshot snapshot() const override {
    return saving_.is_at_work() ? saving_.snapshot() : baking_.snapshot();
  }
  std::vector<std::string> notes() const override { return baking_.progress()->notes(0); }
  void pause(bool is_paused) override {
    const std::scoped_lock lock(mutex_);
    is_paused_ = is_paused;
    if (state_ == LiveState::baking) baking_.set_paused(is_paused);
  }
  void rest(bool is_resting) override {
    const std::scoped_lock lock(mutex_);
    is_resting_ = is_resting;
    if (is_drafted_ && state_ == LiveState::baking) end_early();
  }
  void edit(const SceneNow& now) override {
    const std::scoped_lock lock(mutex_);
    if (!is_read_) return;
    state_ = LiveState::baking;
    baking_.ask({now, ++edits_});
  }
  void save() override {
    const std::scoped_lock lock(mutex_);
    if (state_ == LiveState::baked) saving_.ask(baked_);
  }
  void wait() override { baking_.wait(), saving_.wait(); }

 private:
  using Baker = Worker<Edit, LiveNews>;
  using Saver = Worker<Baked, LiveNews>;

  Status bake(Edit edit, const Baker::Hand& hand, Progress& progress) {
    const RunWatcher watcher{
        hand, [this](const light::TexelScene& in, size_t element) { return is_seen(in, element); }};
    const Status done =
        edit.now ? bake_edit(edit, watcher, progress) : bake_file(watcher, progress);
    // An edit that has come meanwhile is no failure.
    return done || is_newest(edit) ? done : Status();
  }
  Status bake_file(const RunWatcher& watcher, Progress& progress) {
    BakeRun run(settings_, watcher, progress);
    pipeline::BakeObserver observer;
    observer.on_read = [&](const scene::Scene& scene) {
      auto read = read_scene(scene, settings_, TracedFor::edits);
      if (!read) return;  // the bake ends with the same error
      has_read(*read);
      progress.begin("draft", 0);
      // Without a draft, the window waits for the bake itself.
      if (run.begin(*read, kFirstDraft, progress)) observer.guess = run.observer().guess;
      has_draft();
    };
    observer.on_estimate = run.observer().on_estimate;
    observer.on_bounce = run.observer().on_bounce;
    observer.is_watched = watcher.is_seen;
    pipeline::BakeCache cache(settings_, pipeline::settings_of_kept_bake(settings_));
    return end({}, run, pipeline::bake_scene(settings_, progress, {nullptr, &cache}, observer),
               cache, progress);
  }

  void has_read(std::shared_ptr<const ReadScene> read) {
    as_read_ = std::move(read);
    const std::scoped_lock lock(mutex_);
    is_read_ = true;
  }

  /// From now on the bake can end early, and does where it is to rest.
  void has_draft() {
    const std::scoped_lock lock(mutex_);
    is_drafted_ = true;
    end_early();
  }
  /// Under the mutex.
  void end_early() {
    if (!is_resting_) return;
    ends_early_ = true;
    baking_.stop();
  }

  /// The draft comes to its end though there are other edits: it is soon there.
  Status bake_edit(const Edit& edit, const RunWatcher& watcher, Progress& progress) {
    begin_edit();
    BakeRun run(of_edits_, watcher, progress);
    if (exposure_) run.follow(*exposure_, known_, is_known_shown_);
    progress.begin("draft", 0);
    LUXEL_TRY(auto read, read_scene(edited(as_read_->scene, *edit.now), *as_read_));
    Status begun;  // somebody waits for it
    errands_.run([&] { begun = run.begin(read, kQuickDraft, ends_); });
    LUXEL_TRY_STATUS(begun);
    is_known_shown_ = is_known_shown_ || run.follows();
    has_draft();
    {
      const std::scoped_lock lock(mutex_);
      if (!is_resting_) progress.set_paused(is_paused_);
    }
    pipeline::BakeCache cache(of_edits_, pipeline::settings_of_kept_bake(of_edits_));
    return end(edit, run,
               pipeline::bake_read_scene(read->scene, of_edits_, progress, {nullptr, &cache},
                                         run.observer()),
               cache, progress);
  }
  void begin_edit() {
    const std::scoped_lock lock(mutex_);
    baked_ = {};
    is_drafted_ = ends_early_ = false;
  }

  Status end(const Edit& edit, BakeRun& run, Result<pipeline::Bake> baked,
             pipeline::BakeCache& cache, Progress& progress) {
    progress.finish();
    exposure_ = run.exposure();
    learn(run);
    if (!baked && comes_to_rest(edit)) return {};
    if (!baked) return Failure{baked.error()};
    cache.finish(progress);
    if (!cache.failure().empty()) baked->warnings.push_back(cache.failure());
    const auto whole = std::make_shared<const pipeline::Bake>(std::move(*baked));
    run.end(*whole);
    exposure_ = run.exposure();
    // It may lie as a sum of kept layers does, of which nothing is known.
    if (!run.known()) is_known_shown_ = false;
    {
      const std::scoped_lock lock(mutex_);
      baked_ = {whole, baking_.progress()};
      if (edit.number == edits_) state_ = LiveState::baked;
    }
    if (settings_.light == pipeline::LightPart::all) run.tell_lamps_apart(progress);
    return {};
  }
  bool is_newest(const Edit& edit) const {
    const std::scoped_lock lock(mutex_);
    return edit.number == edits_;
  }
  /// True: a bake that has not come to its end was to rest.
  bool comes_to_rest(const Edit& edit) {
    const std::scoped_lock lock(mutex_);
    if (ends_early_ && edit.number == edits_) state_ = LiveState::paused;
    return ends_early_;
  }
  /// Light that is known in part is better than none. But where it follows an edit it is made of an
  /// estimate: what is known as a whole is a better ground for the next.
  void learn(const BakeRun& run) {
    const std::shared_ptr<const KnownLight> light = run.known();
    const bool is_better = light && (!known_ || run.knows_all());
    if (is_better) known_ = light;
    if (run.lies_anew()) is_known_shown_ = is_better;
  }
  Status write(const Baked& baked, const Saver::Hand& hand, Progress& progress) const {
    return pipeline::save_bake(settings_, *baked.bake, *baked.progress, progress)
        .map([&](const nlohmann::json&) { hand({.said = "wrote " + settings_.output.string()}); });
  }

  /// True where an element lies in the picture and shows its front.
  bool is_seen(const light::TexelScene& in, size_t element) const {
    std::shared_ptr<const trace::CameraRays> eye;
    {
      const std::scoped_lock lock(mutex_);
      eye = eye_;
    }
    return eye && trace::faces(*eye, in.elements.position[element], in.elements.normal[element]);
  }

  const pipeline::BakeSettings settings_;
  pipeline::BakeSettings of_edits_ = settings_;
  Progress ends_;  ///< cancelled when the thread is to end

  mutable std::mutex mutex_;                      ///< of what follows
  std::shared_ptr<const trace::CameraRays> eye_;  ///< null: nobody has looked yet
  LiveState state_ = LiveState::baking;
  Baked baked_;         ///< of the scene as it is now
  uint64_t edits_ = 0;  ///< so many have been made
  bool is_read_ = false, is_paused_ = false, is_resting_ = false;
  bool is_drafted_ = false;  ///< there is a draft of what is baked, or never will be
  bool ends_early_ = false;  ///< the bake was told to

  // The bake's own.
  std::shared_ptr<const ReadScene> as_read_;
  std::optional<float> exposure_;  ///< of the light that was handed over last
  std::shared_ptr<const KnownLight> known_;
  bool is_known_shown_ = false;  ///< what is shown is laid out as it is
  Errands errands_;              ///< the priority of the window
  Saver saving_;
  Baker baking_;  ///< the last: its thread uses all of the others
};

}  // namespace

std::unique_ptr<LiveBake> LiveBake::begin(const pipeline::BakeSettings& settings) {
  return std::make_unique<LiveWorker>(settings);
}

}  // namespace luxel::view
