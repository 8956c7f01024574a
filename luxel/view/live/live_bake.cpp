#include "luxel/view/live/live_bake.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>
#include <tuple>

#include <nlohmann/json.hpp>

#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/bake/camera.h"
#include "luxel/pipeline/bake/finish_bake.h"
#include "luxel/post/dilate.h"
#include "luxel/transport/irradiance_field.h"

namespace luxel::view {
namespace {

/// The picture whose exposure is chosen: as large as it must be for percentiles of luminance.
constexpr int kSmallWidth = 128, kSmallHeight = 96;

Result<std::shared_ptr<const ReadScene>> read_scene(const scene::Scene& scene,
                                                    const pipeline::BakeSettings& settings) {
  auto out = std::make_shared<ReadScene>();
  out->scene = scene;
  LUXEL_TRY(trace::RayTracer tracer, trace::RayTracer::build(out->scene));
  out->tracer.emplace(std::move(tracer));
  LUXEL_TRY(out->first.camera,
            pipeline::choose_camera({.view = settings.view, .aspect = pipeline::kPreviewAspect},
                                    out->scene, *out->tracer, settings.scene.string()));
  std::tie(out->width, out->height) = pipeline::preview_size(out->first.camera);
  return out;
}

std::vector<image::HalfImage> halves_of(std::span<const image::Image> pages) {
  std::vector<image::HalfImage> out;
  for (const image::Image& page : pages) out.push_back(image::to_half(page));
  return out;
}

/// The lightmap that a bake would write, seams and hidden texels aside.
std::vector<image::HalfImage> pages_of(const light::TexelScene& in, std::span<const Rgb> e) {
  std::vector<image::Image> pages = post::lightmap_pages(in.atlas, in.map, e);
  for (image::Image& page : pages) post::dilate(page, post::kDilationRings);
  return halves_of(pages);
}

Result<float> exposure_of(const light::TexelScene& in, std::span<const Rgb> e,
                          const scene::Camera& camera) {
  const transport::TexelField field{&in.atlas, &in.map, e};
  display::DrawParams params;
  params.width = kSmallWidth, params.height = kSmallHeight, params.samples_per_axis = 1;
  Progress own;  // its stage is not of the bake
  LUXEL_TRY(const image::Image picture,
            display::draw(
                in.scene, in.tracer, camera,
                [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); },
                params, own));
  return display::readable_exposure(picture);
}

/// Seconds of all stages in which rays are traced.
double tracing_seconds(const Progress& progress) {
  double out = 0;
  for (const Stage& stage : progress.stages())
    if (stage.name == "trace rays") out += stage.seconds;
  return out;
}

class Worker : public LiveBake {
 public:
  explicit Worker(const pipeline::BakeSettings& settings) : settings_(settings) {
    thread_ = std::thread([this] { bake(); });
  }
  ~Worker() override {
    progress_.request_cancel();
    if (saving_) saving_->request_cancel();
    thread_.join();
  }

  LiveNews take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(news_, {});
  }
  LiveState state() const override {
    const LiveState state = state_;
    return state == LiveState::baking && is_paused_ ? LiveState::paused : state;
  }
  Progress::Snapshot snapshot() const override {
    return is_saving_ ? saving_->snapshot() : progress_.snapshot();
  }
  void pause(bool is_paused) override {
    is_paused_ = is_paused;
    progress_.set_paused(is_paused);
  }
  void save() override {
    if (state_ != LiveState::baked || is_saving_) return;
    thread_.join();
    saving_ = std::make_unique<Progress>();
    is_saving_ = true;
    thread_ = std::thread([this] { write(); });
  }
  void wait() override { state_.wait(LiveState::baking); }

 private:
  void bake() {
    const LiveState ended = bake_it() ? LiveState::baked : LiveState::failed;
    state_ = ended;
    state_.notify_all();
  }
  bool bake_it() try {
    pipeline::BakeObserver observer;
    observer.on_read = [this](const scene::Scene& scene) { has_read(scene); };
    observer.on_estimate = [this](const light::TexelScene& in, const light::LightEstimate& e) {
      has_light(in, e);
    };
    auto baked = pipeline::bake_scene(settings_, progress_, {}, observer);
    progress_.finish();
    if (!baked) return say(baked.error().message), false;
    baked_.emplace(std::move(*baked));
    has_baked();
    return true;
  } catch (const std::bad_alloc&) {
    return say("out of memory"), false;
  }
  void write() try {
    const auto saved = pipeline::save_bake(settings_, *baked_, progress_, *saving_);
    say(saved ? "wrote " + settings_.output.string() : saved.error().message);
    is_saving_ = false;
  } catch (const std::bad_alloc&) {
    say("out of memory");
    is_saving_ = false;
  }

  void say(std::string sentence) {
    const std::scoped_lock lock(mutex_);
    news_.said = std::move(sentence);
  }
  void has_read(const scene::Scene& scene) {
    auto read = read_scene(scene, settings_);
    if (!read) return;  // the bake ends with the same error
    camera_ = (*read)->first.camera;
    const std::scoped_lock lock(mutex_);
    news_.read = std::move(*read);
  }
  void has_light(const light::TexelScene& in, const light::LightEstimate& estimate) {
    // Light that cannot be held ends the bake with an error.
    for (const Rgb& e : estimate.irradiance)
      if (!std::isfinite(e.x + e.y + e.z)) return;
    LiveLight light;
    light.pages = pages_of(in, estimate.irradiance);
    if (const auto exposure = exposure_of(in, estimate.irradiance, camera_))
      light.exposure = *exposure;
    known_ = {estimate.samples, estimate.error_p95, estimate.error_rms,
              rays_per_s(estimate.samples * double(estimate.irradiance.size()))};
    light.numbers = known_;
    // Vertices are split while nobody waits.
    std::optional<LitScene> lit;
    if (!std::exchange(is_laid_out_, true)) lit = lit_scene(in.scene, in.atlas);
    const std::scoped_lock lock(mutex_);
    if (lit) news_.lit = std::move(lit);
    news_.light = std::move(light);
  }
  void has_baked() {
    LiveLight light;
    light.numbers = known_;
    light.pages = halves_of(baked_->lightmaps);
    light.exposure = baked_->view.exposure, light.is_last = true;
    std::optional<LitScene> lit;  // of a solver that shows no estimates
    if (!is_laid_out_) lit = lit_scene(baked_->scene, baked_->atlas);
    const std::scoped_lock lock(mutex_);
    if (lit) news_.lit = std::move(lit);
    news_.light = std::move(light);
  }
  double rays_per_s(double rays) {
    const double seconds = tracing_seconds(progress_);
    const double more = rays - std::exchange(rays_before_, rays);
    const double in = seconds - std::exchange(seconds_before_, seconds);
    return in > 0 ? more / in : 0;
  }

  const pipeline::BakeSettings settings_;
  Progress progress_;
  std::unique_ptr<Progress> saving_;  ///< made anew by each save()
  mutable std::mutex mutex_;
  LiveNews news_;
  std::atomic<LiveState> state_{LiveState::baking};
  std::atomic<bool> is_saving_{false};
  bool is_paused_ = false;

  // The thread's own.
  scene::Camera camera_;
  bool is_laid_out_ = false;
  LiveNumbers known_;
  double rays_before_ = 0, seconds_before_ = 0;
  std::optional<pipeline::Bake> baked_;  ///< read by save() once `state_` says so
  std::thread thread_;                   ///< the last: it uses all of the others
};

}  // namespace

std::unique_ptr<LiveBake> LiveBake::begin(const pipeline::BakeSettings& settings) {
  return std::make_unique<Worker>(settings);
}

}  // namespace luxel::view
