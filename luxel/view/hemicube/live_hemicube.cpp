#include "luxel/view/hemicube/live_hemicube.h"

#include <functional>
#include <mutex>
#include <utility>

#include "luxel/base/clock.h"
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

/// Light is handed over so many times a second at most.
constexpr double kHandedPerSecond = 30;

/// The solver at work, and what it hands over.
struct Solving {
  const pipeline::BakeSettings& settings;
  std::atomic<double>& pause_at;
  const std::function<void(HemicubeNews)>& hand;
  Progress& progress;
  std::shared_ptr<const ReadScene> read{};  ///< as it was laid out
  std::shared_ptr<const LightMesh> mesh{};
  light::Lights lights{};

  std::mutex mutex{};  ///< of what follows
  GrowingLight growing{};
  size_t reached = 0;  ///< elements that have looked around in this pass
  Clock::time_point handed{};

  Status solve(std::span<const std::filesystem::path> models);
  void has_read(const scene::Scene& scene);
  hemicube::Observer observer_in(const light::TexelScene& in);
  void has_mesh(const hemicube::Field& field);
  void has_view(size_t element, Rgb source, const hemicube::View& view);
  void has_solution(const hemicube::Solution& solution);
  void choose_exposure();
  template <class Change>
  void change(const Change& change) {
    const std::scoped_lock lock(mutex);
    change(growing);
    hand_light();
  }
  /// Under the mutex.
  void hand_light() {
    handed = Clock::now();
    hand({.irradiance = growing.irradiance});
  }
};

/// Bakes as far as the solution.
Status Solving::solve(std::span<const std::filesystem::path> models) {
  pipeline::BakeObserver watcher;
  watcher.on_read = [this](const scene::Scene& scene) { has_read(scene); };
  watcher.hemicube = [this](const light::TexelScene& in) { return observer_in(in); };
  if (models.size() == 1)
    return pipeline::bake_scene(settings, progress, {}, watcher).map([](const auto&) {});
  LUXEL_TRY(scene::Scene scene, read_models(models, settings, progress));
  has_read(scene);
  return pipeline::bake_read_scene(std::move(scene), settings, progress, {}, watcher)
      .map([](const auto&) {});
}

void Solving::has_read(const scene::Scene& scene) {
  // Without it the bake ends with the same error.
  if (auto as_read = read_scene(scene, settings)) hand({.read = std::move(*as_read)});
}

hemicube::Observer Solving::observer_in(const light::TexelScene& in) {
  if (auto laid_out = read_scene(in.scene, settings)) read = std::move(*laid_out);
  lights = in.lights;
  hand({.read = read});
  hemicube::Observer out;
  out.on_mesh = [this](const hemicube::Field& field) { has_mesh(field); };
  out.on_direct = [this](std::span<const Rgb> direct) {
    change([&](GrowingLight& light) { begin_pass(direct, light), reached = 0; });
    choose_exposure();
  };
  out.on_view = [this](size_t element, Rgb source, const hemicube::View& view) {
    has_view(element, source, view);
  };
  out.on_bounce = [this](std::span<const Rgb> irradiance) {
    change([&](GrowingLight& light) { take_bounce(irradiance, light); });
  };
  out.on_solved = [this](const hemicube::Solution& solution) { has_solution(solution); };
  return out;
}

void Solving::has_mesh(const hemicube::Field& field) {
  if (!read) return;
  mesh = std::make_shared<const LightMesh>(LightMesh{read, field.mesh, field.receivers,
                                                     hemicube::choose_emission(lights),
                                                     pipeline::hemicube_params(settings)});
  hand({.mesh = mesh});
  change([&](GrowingLight& light) {
    light = begin_growing(field.receivers.elements.reflectance, field.irradiance);
  });
}

void Solving::has_view(size_t element, Rgb source, const hemicube::View& view) {
  const std::scoped_lock lock(mutex);
  reach(element, source, view, growing);
  const bool is_to_pause = double(++reached) >= pause_at * double(growing.irradiance.size());
  if (is_to_pause || kHandedPerSecond * seconds_since(handed) > 1) hand_light();
  if (!is_to_pause) return;
  pause_at = 2;
  progress.set_paused(true);
}

void Solving::has_solution(const hemicube::Solution& solution) {
  // A field that is smoothed has light per vertex, though it was solved per triangle.
  if (!mesh || mesh->receivers.kind != solution.field.receivers.kind) has_mesh(solution.field);
  change([&](GrowingLight& light) { take_bounce(solution.field.irradiance, light); });
  choose_exposure();
  hand({.is_solved = true});
  // The bake ends here: the window shows nothing that it would make of the solution.
  progress.request_cancel();
}

/// At which the first view is readable.
void Solving::choose_exposure() {
  if (!mesh) return;
  hemicube::Field field{mesh->mesh, mesh->receivers, {}};
  {
    const std::scoped_lock lock(mutex);
    field.irradiance = growing.irradiance;
  }
  display::DrawParams params;
  params.width = kGlimpseWidth, params.height = kGlimpseHeight, params.samples_per_axis = 1;
  Progress own;  // its stage is not of the solver
  const auto picture = display::draw(
      read->scene, *read->tracer, read->first.camera,
      [&](const scene::SurfacePoint& p) { return hemicube::irradiance_at(field, p); }, params, own);
  if (picture) hand({.exposure = display::readable_exposure(*picture)});
}

}  // namespace

void merge(HemicubeNews newer, HemicubeNews& news) {
  if (newer.read) news.read = std::move(newer.read);
  if (newer.mesh) news.mesh = std::move(newer.mesh);
  if (!newer.irradiance.empty()) news.irradiance = std::move(newer.irradiance);
  if (newer.exposure > 0) news.exposure = newer.exposure;
  if (newer.said) news.said = std::move(newer.said);
  news.is_solved = news.is_solved || newer.is_solved;
}

LiveHemicube::LiveHemicube(std::vector<std::filesystem::path> models,
                           const pipeline::BakeSettings& settings)
    : worker_([this, settings](const auto& asked, const auto& hand, Progress& progress) {
        return Solving{settings, pause_at_, hand, progress}.solve(asked);
      }) {
  worker_.ask(std::move(models));
}

HemicubeNews LiveHemicube::take() {
  HemicubeNews out;
  for (Result<HemicubeNews>& news : worker_.take()) {
    if (news)
      merge(std::move(*news), out);
    else
      out.said = news.error().message;
  }
  is_solved_ = is_solved_ || out.is_solved;
  return out;
}

HemicubeState LiveHemicube::state() const {
  if (worker_.is_paused()) return HemicubeState::paused;
  if (worker_.is_busy()) return HemicubeState::solving;
  return is_solved_ ? HemicubeState::solved : HemicubeState::failed;
}

void LiveHemicube::pause(bool is_paused) {
  if (!is_paused) pause_at_ = 2;
  worker_.set_paused(is_paused);
}

}  // namespace luxel::view
