#include "luxel/view/live/live_bake.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>

#include <nlohmann/json.hpp>

#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/pipeline/bake/finish_bake.h"
#include "luxel/post/dilate.h"
#include "luxel/trace/camera_rays.h"
#include "luxel/transport/irradiance_field.h"
#include "luxel/view/live/draft.h"

namespace luxel::view {
namespace {

/// The picture whose exposure is chosen: as large as it must be for percentiles of luminance.
constexpr int kSmallWidth = 128, kSmallHeight = 96;
/// The height of the picture whose texels come first; only its shape counts.
constexpr int kViewHeight = 1000;

std::vector<image::HalfImage> halves_of(std::span<const image::Image> pages) {
  std::vector<image::HalfImage> out;
  for (const image::Image& page : pages) out.push_back(image::to_half(page));
  return out;
}

/// The lightmap that a bake would write, seams and hidden texels aside.
std::vector<image::HalfImage> pages_of(const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                       std::span<const Rgb> e) {
  std::vector<image::Image> pages = post::lightmap_pages(atlas, map, e);
  for (image::Image& page : pages) post::dilate(page, post::kDilationRings);
  return halves_of(pages);
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
  void look(const scene::Camera& camera, float aspect) override {
    auto eye =
        std::make_shared<const trace::CameraRays>(camera, int(kViewHeight * aspect), kViewHeight);
    const std::scoped_lock lock(mutex_);
    eye_ = std::move(eye);
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
  void wait() override {
    state_.wait(LiveState::baking);
    is_saving_.wait(true);
  }

 private:
  void bake() {
    const LiveState ended = bake_it() ? LiveState::baked : LiveState::failed;
    state_ = ended;
    state_.notify_all();
  }
  bool bake_it() try {
    observer_.on_read = [this](const scene::Scene& scene) { has_read(scene); };
    observer_.on_estimate = [this](const light::TexelScene& in, const light::LightEstimate& e) {
      has_light(in, e);
    };
    observer_.is_watched = [this](const light::TexelScene& in, size_t element) {
      return is_seen(in, element);
    };
    auto baked = pipeline::bake_scene(settings_, progress_, {}, observer_);
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
    has_saved();
  } catch (const std::bad_alloc&) {
    say("out of memory");
    has_saved();
  }
  void has_saved() {
    is_saving_ = false;
    is_saving_.notify_all();
  }

  void say(std::string sentence) {
    const std::scoped_lock lock(mutex_);
    news_.said = std::move(sentence);
  }
  void has_read(const scene::Scene& scene) {
    auto read = read_scene(scene, settings_);
    if (!read) return;  // the bake ends with the same error
    camera_ = (*read)->first.camera;
    {
      const std::scoped_lock lock(mutex_);
      news_.read = std::move(*read);
    }
    // Without one, the window waits for the bake itself.
    progress_.begin("draft", 0);
    if (auto draft = make_draft(scene, settings_, progress_)) draft_ = std::move(*draft);
    if (!draft_) return;
    has_draft();
    observer_.guess = [this](const light::TexelScene& in, std::span<const Rgb> direct) {
      return with_reflections_of_draft(in, direct);
    };
  }
  void has_draft() {
    LiveLight light;
    light.numbers.kind = LiveKind::draft;
    light.pages = pages_of(draft_->atlas, draft_->map, draft_->irradiance);
    light.exposure = draft_exposure_ = exposure_of(
        {draft_->scene, *draft_->tracer}, {&draft_->atlas, &draft_->map, draft_->irradiance});
    const std::scoped_lock lock(mutex_);
    news_.lit = lit_scene(draft_->scene, draft_->atlas);
    news_.light = std::move(light);
  }
  void has_light(const light::TexelScene& in, const light::LightEstimate& estimate) {
    // Light that cannot be held ends the bake with an error.
    for (const Rgb& e : estimate.irradiance)
      if (!std::isfinite(e.x + e.y + e.z)) return;
    LiveLight light;
    light.pages = pages_of(in.atlas, in.map, estimate.irradiance);
    light.exposure = exposure_of({in.scene, in.tracer}, {&in.atlas, &in.map, estimate.irradiance});
    const LiveKind guess = draft_ ? LiveKind::direct_and_draft : LiveKind::direct_and_even_rest;
    const LiveKind kind = estimate.share == 0   ? guess
                          : estimate.share == 1 ? LiveKind::bake
                                                : LiveKind::partly;
    known_ = {kind,
              estimate.share,
              estimate.samples,
              estimate.error_p95,
              estimate.error_rms,
              rays_per_s(estimate.samples * double(estimate.irradiance.size()))};
    light.numbers = known_;
    // Vertices are split while nobody waits.
    std::optional<LitScene> lit;
    std::optional<LiveLight> before;
    if (!std::exchange(is_laid_out_, true)) {
      lit = lit_scene(in.scene, in.atlas);
      if (draft_) before = draft_elsewhere(in);
    }
    const std::scoped_lock lock(mutex_);
    if (lit) news_.lit = std::move(lit), news_.before = std::move(before);
    news_.light = std::move(light);
  }
  LiveLight draft_elsewhere(const light::TexelScene& in) const {
    LiveLight out;
    out.pages = pages_of(in.atlas, in.map, light_of_draft(*draft_, draft_->irradiance, in));
    out.exposure = draft_exposure_;
    return out;
  }
  /// What surfaces send each other, by the draft, and direct light of the bake.
  std::vector<Rgb> with_reflections_of_draft(const light::TexelScene& in,
                                             std::span<const Rgb> direct) const {
    std::vector<Rgb> reflected = draft_->irradiance;
    for (size_t i = 0; i < reflected.size(); ++i) reflected[i] = reflected[i] - draft_->direct[i];
    std::vector<Rgb> out = light_of_draft(*draft_, reflected, in);
    for (size_t i = 0; i < out.size(); ++i) out[i] = max(out[i], Rgb{}) + direct[i];
    return out;
  }
  void has_baked() {
    known_.kind = LiveKind::bake;
    LiveLight light;
    light.numbers = known_;
    light.pages = halves_of(baked_->lightmaps);
    light.exposure = baked_->view.exposure, light.is_last = true;
    std::optional<LitScene> lit;  // of a solver that shows no estimates
    if (!is_laid_out_) lit = lit_scene(baked_->scene, baked_->atlas);
    const std::scoped_lock lock(mutex_);
    if (lit) news_.lit = std::move(lit);
    news_.light = std::move(light);
    news_.warnings = baked_->warnings;
  }
  struct Traced {
    const scene::Scene& scene;
    const trace::RayTracer& tracer;
  };
  /// At which the first view is readable.
  float exposure_of(const Traced& in, const transport::TexelField& field) const {
    display::DrawParams params;
    params.width = kSmallWidth, params.height = kSmallHeight, params.samples_per_axis = 1;
    Progress own;  // its stage is not of the bake
    const auto picture = display::draw(
        in.scene, in.tracer, camera_,
        [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); }, params,
        own);
    return picture ? display::readable_exposure(*picture) : 1;
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
  std::shared_ptr<const trace::CameraRays> eye_;  ///< null: nobody has looked yet
  std::atomic<LiveState> state_{LiveState::baking};
  std::atomic<bool> is_saving_{false};
  bool is_paused_ = false;

  // The thread's own.
  pipeline::BakeObserver observer_;
  scene::Camera camera_;          ///< of the first view
  std::unique_ptr<Draft> draft_;  ///< null: there is none
  float draft_exposure_ = 1;
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
