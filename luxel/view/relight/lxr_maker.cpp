#include "luxel/view/relight/lxr_maker.h"

#include <condition_variable>
#include <mutex>
#include <thread>

#include <nlohmann/json.hpp>

#include "luxel/base/output_folder.h"
#include "luxel/base/parallel.h"
#include "luxel/base/thread_priority.h"

namespace luxel::view {
namespace {

Lamps without_deleted(const SceneNow& now) {
  Lamps out;
  for (const EditedLamp& lamp : now.lamps)
    if (!lamp.is_deleted) out.lamps.push_back(lamp);
  return out;
}

/// Lamps that are off keep their number, and shine not.
scene::Scene scene_to_make(const LxrToMake& to_make) {
  scene::Scene out = edited(to_make.read->scene, to_make.now);
  out.lights.clear();
  for (const Lamp& lamp : without_deleted(to_make.now).lamps) {
    out.lights.push_back(lamp.light);
    if (!lamp.is_on) out.lights.back().intensity = {};
  }
  return out;
}

class Maker : public LxrMaker {
 public:
  explicit Maker(LxrToMake to_make) : to_make_(std::move(to_make)), thread_([this] { work(); }) {}
  ~Maker() override {
    progress_.request_cancel();
    thread_.join();
  }

  Progress::Snapshot snapshot() const override { return progress_.snapshot(); }
  std::optional<Result<MadeLxr>> take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(made_, std::nullopt);
  }
  void wait() override {
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return has_ended_; });
  }

 private:
  void work() {
    lower_priority_of_this_thread();
    auto result = made();
    const std::scoped_lock lock(mutex_);
    made_.emplace(std::move(result)), has_ended_ = true;
    ended_.notify_all();
  }

  Result<MadeLxr> made() try {
    const pipeline::RelightSettings& settings = to_make_.settings;
    progress_.begin("look for a prepared file", 0);
    const scene::Scene scene = scene_to_make(to_make_);
    std::optional<pipeline::Relightable> data = kept_lxr(scene, settings);
    const bool was_there = data.has_value();
    LUXEL_TRY_STATUS(stopped(progress_));
    if (!was_there) {
      LUXEL_TRY(data, made_anew(scene));
    }
    progress_.begin("open it", 0);
    LUXEL_TRY(OpenedLxr opened,
              opened_lxr(std::move(data->data), settings.output, to_make_.read.get()));
    switch_off(opened);
    return MadeLxr{std::move(opened), std::move(data->warnings), was_there};
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_memory, "out of memory");
  }

  Result<pipeline::Relightable> made_anew(const scene::Scene& scene) {
    const pipeline::RelightSettings& settings = to_make_.settings;
    OutputFolder folder(settings.output.parent_path());
    LUXEL_TRY_STATUS(folder.make());
    LUXEL_TRY_STATUS(pipeline::check(settings));
    const ThreadLimit threads(settings.threads);
    LUXEL_TRY(pipeline::Relightable made, pipeline::make_relightable(scene, settings, progress_));
    // One that was stopped meanwhile may have taken the folder along.
    LUXEL_TRY_STATUS(folder.make());
    LUXEL_TRY_STATUS(
        pipeline::write_relightable(settings, made, progress_).map([](const nlohmann::json&) {}));
    folder.keep();
    if (const Status kept = keep_lxr(scene, settings, made.warnings); !kept)
      made.warnings.push_back("the file cannot be used again: " + kept.error().message);
    return made;
  }

  /// A file has no lamps that are off: they are dark there.
  void switch_off(OpenedLxr& opened) const {
    const std::vector<Lamp> lamps = without_deleted(to_make_.now).lamps;
    for (size_t i = 0; i < lamps.size(); ++i)
      if (!lamps[i].is_on) opened.lamps.lamps[i] = lamps[i];
  }

  const LxrToMake to_make_;
  Progress progress_;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::optional<Result<MadeLxr>> made_;  ///< under the mutex
  bool has_ended_ = false;               ///< under the mutex
  std::thread thread_;                   ///< the last: it uses all of the others
};

}  // namespace

std::unique_ptr<LxrMaker> LxrMaker::begin(LxrToMake to_make) {
  return std::make_unique<Maker>(std::move(to_make));
}

}  // namespace luxel::view
