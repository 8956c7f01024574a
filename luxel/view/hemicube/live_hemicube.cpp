#include "luxel/view/hemicube/live_hemicube.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include "luxel/base/thread_priority.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/import/import.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/solver/hemicube.h"
#include "luxel/scene/merge.h"
#include "luxel/view/hemicube/growing_light.h"

namespace luxel::view {
namespace {

/// The picture whose exposure is chosen.
constexpr int kGlimpseWidth = 128, kGlimpseHeight = 96;

Result<scene::Scene> read_models(std::span<const std::filesystem::path> models,
                                 const pipeline::BakeSettings& settings, Progress& progress) {
  std::vector<scene::Scene> scenes;
  import::ImportParams reading = settings.reading;
  progress.begin("import", models.size());
  for (const std::filesystem::path& model : models) {
    LUXEL_TRY(import::Imported imported,
              import::import_scene(model, reading, settings.max_memory_bytes));
    scenes.push_back(std::move(imported.scene));
    reading.origin = scenes[0].origin;
    progress.advance(1);
    LUXEL_TRY_STATUS(stopped(progress));
  }
  scene::Scene out = scene::merged(scenes);
  LUXEL_TRY_STATUS(pipeline::add_outside_light(settings.outside, out).map([](const auto&) {}));
  return out;
}

class HemicubeWorker : public LiveHemicube {
 public:
  HemicubeWorker(std::vector<std::filesystem::path> models, const pipeline::BakeSettings& settings)
      : models_(std::move(models)), settings_(settings) {
    thread_ = std::thread([this] { work(); });
  }
  ~HemicubeWorker() override {
    progress_.request_cancel();
    thread_.join();
  }

  HemicubeNews take() override {
    const std::scoped_lock lock(mutex_);
    if (std::exchange(has_new_light_, false)) news_.irradiance = growing_.irradiance;
    return std::exchange(news_, {});
  }
  HemicubeState state() const override {
    const HemicubeState state = state_;
    return state == HemicubeState::solving && is_paused_ ? HemicubeState::paused : state;
  }
  Progress::Snapshot snapshot() const override { return progress_.snapshot(); }
  void pause(bool is_paused) override {
    if (!is_paused) pause_at_ = 2;
    is_paused_ = is_paused;
    progress_.set_paused(is_paused);
  }
  void pause_at(double share) override { pause_at_ = share; }

 private:
  void work() {
    lower_priority_of_this_thread();
    const bool solved = solve() || is_solved_;
    progress_.finish();
    state_ = solved ? HemicubeState::solved : HemicubeState::failed;
  }
  /// Bakes as far as the solution.
  bool solve() try {
    pipeline::BakeObserver watcher;
    watcher.on_read = [this](const scene::Scene& scene) { has_read(scene); };
    watcher.hemicube = [this](const light::TexelScene& in) { return observer_in(in); };
    Status done;
    if (models_.size() == 1) {
      done = pipeline::bake_scene(settings_, progress_, {}, watcher).map([](const auto&) {});
    } else {
      auto scene = read_models(models_, settings_, progress_);
      if (!scene) return say(scene.error().message), false;
      has_read(*scene);
      done = pipeline::bake_read_scene(std::move(*scene), settings_, progress_, {}, watcher)
                 .map([](const auto&) {});
    }
    if (!done && !is_solved_) say(done.error().message);
    return done.has_value();
  } catch (const std::bad_alloc&) {
    return say("out of memory"), false;
  }

  void say(std::string sentence) {
    const std::scoped_lock lock(mutex_);
    news_.said = std::move(sentence);
  }
  void has_read(const scene::Scene& scene) {
    auto read = read_scene(scene, settings_);
    if (!read) return;  // the bake ends with the same error
    const std::scoped_lock lock(mutex_);
    news_.read = std::move(*read);
  }

  hemicube::Observer observer_in(const light::TexelScene& in) {
    if (auto read = read_scene(in.scene, settings_)) read_ = std::move(*read);
    lights_ = in.lights;
    {
      const std::scoped_lock lock(mutex_);
      news_.read = read_;
    }
    hemicube::Observer out;
    out.on_mesh = [this](const hemicube::Field& field) { has_mesh(field); };
    out.on_direct = [this](std::span<const Rgb> direct) {
      change([&] { begin_pass(direct, growing_), reached_ = 0; });
      choose_exposure();
    };
    out.on_view = [this](size_t element, Rgb source, const hemicube::View& view) {
      has_view(element, source, view);
    };
    out.on_bounce = [this](std::span<const Rgb> irradiance) {
      change([&] { take_bounce(irradiance, growing_); });
    };
    out.on_solved = [this](const hemicube::Solution& solution) { has_solution(solution); };
    return out;
  }
  template <class Change>
  void change(const Change& change) {
    const std::scoped_lock lock(mutex_);
    change();
    has_new_light_ = true;
  }
  void has_mesh(const hemicube::Field& field) {
    if (!read_) return;
    auto mesh = std::make_shared<const LightMesh>(LightMesh{read_, field.mesh, field.receivers,
                                                            hemicube::choose_emission(lights_),
                                                            pipeline::hemicube_params(settings_)});
    const std::scoped_lock lock(mutex_);
    mesh_ = mesh;
    news_.mesh = std::move(mesh);
    growing_ = begin_growing(field.receivers.elements.reflectance, field.irradiance);
    has_new_light_ = true;
  }
  void has_view(size_t element, Rgb source, const hemicube::View& view) {
    const std::scoped_lock lock(mutex_);
    reach(element, source, view, growing_);
    has_new_light_ = true;
    if (double(++reached_) < pause_at_ * double(growing_.irradiance.size())) return;
    pause_at_ = 2;
    is_paused_ = true;
    progress_.set_paused(true);
  }
  void has_solution(const hemicube::Solution& solution) {
    // A field that is smoothed has light per vertex, though it was solved per triangle.
    if (!mesh_ || mesh_->receivers.kind != solution.field.receivers.kind) has_mesh(solution.field);
    change([&] { take_bounce(solution.field.irradiance, growing_); });
    choose_exposure();
    // What a bake does with it is not looked at.
    is_solved_ = true;
    progress_.request_cancel();
  }

  /// At which the first view is readable.
  void choose_exposure() {
    if (!mesh_) return;
    hemicube::Field field{mesh_->mesh, mesh_->receivers, {}};
    {
      const std::scoped_lock lock(mutex_);
      field.irradiance = growing_.irradiance;
    }
    display::DrawParams params;
    params.width = kGlimpseWidth, params.height = kGlimpseHeight, params.samples_per_axis = 1;
    Progress own;  // its stage is not of the solver
    const auto picture = display::draw(
        read_->scene, *read_->tracer, read_->first.camera,
        [&](const scene::SurfacePoint& p) { return hemicube::irradiance_at(field, p); }, params,
        own);
    if (!picture) return;
    const std::scoped_lock lock(mutex_);
    news_.exposure = display::readable_exposure(*picture);
  }

  const std::vector<std::filesystem::path> models_;
  const pipeline::BakeSettings settings_;
  Progress progress_;
  mutable std::mutex mutex_;  ///< of what follows
  HemicubeNews news_;
  GrowingLight growing_;
  bool has_new_light_ = false;
  size_t reached_ = 0;  ///< elements that have looked around in this pass

  std::atomic<HemicubeState> state_{HemicubeState::solving};
  std::atomic<bool> is_paused_{false}, is_solved_{false};
  std::atomic<double> pause_at_{2};

  // The thread's own.
  std::shared_ptr<const ReadScene> read_;  ///< as it was laid out
  std::shared_ptr<const LightMesh> mesh_;
  light::Lights lights_;
  std::thread thread_;  ///< the last: it uses all of the others
};

}  // namespace

std::unique_ptr<LiveHemicube> LiveHemicube::begin(std::vector<std::filesystem::path> models,
                                                  const pipeline::BakeSettings& settings) {
  return std::make_unique<HemicubeWorker>(std::move(models), settings);
}

}  // namespace luxel::view
