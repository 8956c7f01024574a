#include "luxel/view/live/live_bake.h"

#include <condition_variable>
#include <mutex>
#include <thread>

#include <nlohmann/json.hpp>

#include "luxel/base/check.h"
#include "luxel/base/errands.h"
#include "luxel/base/thread_priority.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/reuse/bake_cache.h"
#include "luxel/pipeline/solver/bake_options.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/view/live/bake_run.h"

namespace luxel::view {
namespace {

/// The height of the picture whose texels come first; only its shape counts.
constexpr int kViewHeight = 1000;

class Worker : public LiveBake {
 public:
  explicit Worker(const pipeline::BakeSettings& settings) : settings_(settings) {
    of_edits_.outside = {};  // the scene has it
    thread_ = std::thread([this] { work(); });
  }
  ~Worker() override {
    {
      const std::scoped_lock lock(mutex_);
      is_ending_ = true;
      ends_.request_cancel();
      progress_->request_cancel();
      if (saving_) saving_->request_cancel();
    }
    changed_.notify_all();
    thread_.join();
  }

  LiveNews take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(news_, {});
  }
  void look(const scene::Camera& camera, float aspect) override {
    auto eye =
        std::make_shared<const trace::CameraRays>(camera, int(kViewHeight * aspect), kViewHeight);
    const std::scoped_lock lock(mutex_);
    eye_ = std::move(eye);
  }
  LiveState state() const override {
    const std::scoped_lock lock(mutex_);
    return state_ == LiveState::baking && is_paused_ ? LiveState::paused : state_;
  }
  Progress::Snapshot snapshot() const override {
    const std::scoped_lock lock(mutex_);
    return saving_ ? saving_->snapshot() : progress_->snapshot();
  }
  std::vector<std::string> notes() const override {
    const std::scoped_lock lock(mutex_);
    return progress_->notes(0);
  }
  void pause(bool is_paused) override {
    const std::scoped_lock lock(mutex_);
    is_paused_ = is_paused;
    // What is cancelled must not be held.
    if (state_ == LiveState::baking && !edit_) progress_->set_paused(is_paused);
  }
  void rest(bool is_resting) override {
    const std::scoped_lock lock(mutex_);
    is_resting_ = is_resting;
    if (is_drafted_ && state_ == LiveState::baking) end_early();
  }
  void edit(const SceneNow& now) override {
    const std::scoped_lock lock(mutex_);
    if (!is_read_) return;
    edit_ = now;
    state_ = LiveState::baking;
    progress_->request_cancel();
    changed_.notify_all();
  }
  void save() override {
    const std::scoped_lock lock(mutex_);
    if (state_ != LiveState::baked) return;
    asks_to_save_ = true;
    changed_.notify_all();
  }
  void wait() override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !is_busy_ && !edit_ && !asks_to_save_; });
  }

 private:
  void work() {
    lower_priority_of_this_thread();
    guarded([this] { bake_file(); });
    while (wait_for_work()) guarded([this] { edit_ ? bake_edit() : write(); });
  }
  /// False: the thread is to end.
  bool wait_for_work() {
    std::unique_lock lock(mutex_);
    is_busy_ = false;
    changed_.notify_all();
    changed_.wait(lock, [this] { return is_ending_ || edit_ || asks_to_save_; });
    is_busy_ = true;
    return !is_ending_;
  }
  template <typename Body>
  void guarded(const Body& body) try {
    body();
  } catch (const std::bad_alloc&) {
    has_failed("out of memory");
  }

  void bake_file() {
    BakeRun run(settings_, watcher_, *progress_);
    pipeline::BakeObserver observer;
    observer.on_read = [&](const scene::Scene& scene) {
      auto read = read_scene(scene, settings_, TracedFor::edits);
      if (!read) return;  // the bake ends with the same error
      has_read(*read);
      progress_->begin("draft", 0);
      // Without a draft, the window waits for the bake itself.
      if (run.begin(*read, kFirstDraft, *progress_)) observer.guess = run.observer().guess;
      has_draft();
    };
    observer.on_estimate = run.observer().on_estimate;
    observer.on_bounce = run.observer().on_bounce;
    observer.is_watched = watcher_.is_seen;
    pipeline::BakeCache cache(settings_, pipeline::settings_of_kept_bake(settings_));
    end(run, pipeline::bake_scene(settings_, *progress_, {nullptr, &cache}, observer), cache);
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
    progress_->request_cancel();
  }

  /// The draft comes to its end though there are other edits: it is soon there.
  void bake_edit() {
    SceneNow now;
    const std::shared_ptr<Progress> progress = begin_edit(now);
    BakeRun run(of_edits_, watcher_, *progress);
    if (exposure_) run.follow(*exposure_, known_, is_known_shown_);
    progress->begin("draft", 0);
    auto read = read_scene(edited(as_read_->scene, now), *as_read_);
    if (!read) return has_failed(read.error().message);
    Status begun;  // somebody waits for it
    errands_.run([&] { begun = run.begin(*read, kQuickDraft, ends_); });
    if (!begun) return has_failed(begun.error().message);
    is_known_shown_ = is_known_shown_ || run.follows();
    has_draft();
    {
      const std::scoped_lock lock(mutex_);
      if (!edit_ && !is_ending_ && !is_resting_) progress->set_paused(is_paused_);
    }
    pipeline::BakeCache cache(of_edits_, pipeline::settings_of_kept_bake(of_edits_));
    end(run,
        pipeline::bake_read_scene((*read)->scene, of_edits_, *progress, {nullptr, &cache},
                                  run.observer()),
        cache);
  }
  std::shared_ptr<Progress> begin_edit(SceneNow& now) {
    baked_.reset();
    const std::scoped_lock lock(mutex_);
    now = std::move(*edit_);
    edit_.reset();
    is_drafted_ = ends_early_ = false;
    progress_ = std::make_shared<Progress>();
    return progress_;
  }

  void end(BakeRun& run, Result<pipeline::Bake> baked, pipeline::BakeCache& cache) {
    progress_->finish();
    exposure_ = run.exposure();
    learn(run);
    if (!baked && comes_to_rest()) return;
    if (!baked) return has_failed(baked.error().message);
    cache.finish(*progress_);
    if (!cache.failure().empty()) baked->warnings.push_back(cache.failure());
    baked_.emplace(std::move(*baked));
    run.end(*baked_);
    exposure_ = run.exposure();
    // It may lie as a sum of kept layers does, of which nothing is known.
    if (!run.known()) is_known_shown_ = false;
    {
      const std::scoped_lock lock(mutex_);
      if (!edit_) state_ = LiveState::baked;
    }
    if (settings_.light == pipeline::LightPart::all) run.tell_lamps_apart(*progress_);
  }
  /// Whether a bake that has not come to its end was to rest.
  bool comes_to_rest() {
    const std::scoped_lock lock(mutex_);
    if (ends_early_ && !edit_) state_ = LiveState::paused;
    if (ends_early_) asks_to_save_ = false;  // there is nothing
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
  /// An edit that has come meanwhile is no failure.
  void has_failed(std::string sentence) {
    const std::scoped_lock lock(mutex_);
    if (edit_) return;
    asks_to_save_ = false;
    news_.said = std::move(sentence);
    state_ = LiveState::failed;
  }
  void write() {
    LUXEL_CHECK(baked_.has_value());
    const auto saving = std::make_shared<Progress>();
    set_saving(saving);
    const auto saved = pipeline::save_bake(settings_, *baked_, *progress_, *saving);
    set_saving(nullptr);
    const std::scoped_lock lock(mutex_);
    asks_to_save_ = false;
    news_.said = saved ? "wrote " + settings_.output.string() : saved.error().message;
  }
  void set_saving(std::shared_ptr<Progress> saving) {
    const std::scoped_lock lock(mutex_);
    saving_ = std::move(saving);
    if (saving_ && is_ending_) saving_->request_cancel();
  }

  void hand(LiveNews news) {
    const std::scoped_lock lock(mutex_);
    add(std::move(news), news_);
  }
  /// Whether an element lies in the picture and shows its front.
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
  const RunWatcher watcher_{
      [this](LiveNews news) { hand(std::move(news)); },
      [this](const light::TexelScene& in, size_t element) { return is_seen(in, element); }};
  Progress ends_;  ///< cancelled when the thread is to end

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Under the mutex:
  LiveNews news_;
  std::shared_ptr<const trace::CameraRays> eye_;  ///< null: nobody has looked yet
  LiveState state_ = LiveState::baking;
  std::shared_ptr<Progress> progress_ = std::make_shared<Progress>();  ///< of the last bake
  std::shared_ptr<Progress> saving_;                                   ///< null: nothing is saved
  std::optional<SceneNow> edit_;                                       ///< the next
  bool is_read_ = false, asks_to_save_ = false, is_paused_ = false, is_busy_ = true,
       is_ending_ = false;
  bool is_drafted_ = false;  ///< there is a draft of what is baked, or never will be
  bool is_resting_ = false;
  bool ends_early_ = false;  ///< the bake was told to

  // The thread's own.
  std::shared_ptr<const ReadScene> as_read_;
  std::optional<float> exposure_;  ///< of the light that was handed over last
  std::shared_ptr<const KnownLight> known_;
  bool is_known_shown_ = false;          ///< what is shown is laid out as it is
  std::optional<pipeline::Bake> baked_;  ///< of the scene as it is now
  Errands errands_;                      ///< the priority of the window
  std::thread thread_;                   ///< the last: it uses all of the others
};

}  // namespace

std::unique_ptr<LiveBake> LiveBake::begin(const pipeline::BakeSettings& settings) {
  return std::make_unique<Worker>(settings);
}

}  // namespace luxel::view
