#include "luxel/view/live/bake_run.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/parallel.h"
#include "luxel/display/draw.h"
#include "luxel/display/tone_map.h"
#include "luxel/pipeline/bake/finish_bake.h"
#include "luxel/post/dilate.h"
#include "luxel/post/refill.h"
#include "luxel/view/live/lamp_light.h"

namespace luxel::view {
namespace {

/// The picture whose exposure is chosen: as large as it must be for percentiles of luminance.
constexpr int kSmallWidth = 128, kSmallHeight = 96;
/// For the rays of an estimate, so that its picture is there within 0.2 s.
constexpr double kEstimate_s = 0.1;
/// Memory for the light after each reflection, before it is made into pictures.
constexpr size_t kBouncedBytes = 256 << 20;
/// So many texels are looked up in a draft within some tenths of a second.
constexpr size_t kSoonLookedUp = 2'000'000;

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

std::shared_ptr<const BouncedLight> bounces_of(const Draft& draft) {
  const auto out = std::make_shared<BouncedLight>();
  out->is_draft = true;
  for (const std::vector<Rgb>& e : draft.bounced)
    out->after.push_back(pages_of(draft.atlas, draft.map, e));
  return out;
}

}  // namespace

BakeRun::BakeRun(const pipeline::BakeSettings& settings, const RunWatcher& watcher,
                 const Progress& progress)
    : settings_(settings), watcher_(watcher), progress_(progress) {}

void BakeRun::follow(float exposure, std::shared_ptr<const KnownLight> before, bool is_shown) {
  kept_exposure_ = exposure_ = exposure;
  // Estimates have all light.
  if (settings_.bounces < 0 && settings_.light == pipeline::LightPart::all)
    before_ = std::move(before), is_before_shown_ = is_shown;
}

Status BakeRun::begin(std::shared_ptr<const ReadScene> read, const DraftParams& params,
                      const Progress& ends) {
  read_ = std::move(read), camera_ = read_->first.camera;
  // The scene that was read is shown during its first draft; after an edit, older light is shown.
  LiveNews news;
  news.read = read_;
  if (!kept_exposure_) watcher_.hand(std::exchange(news, {}));
  LUXEL_TRY(draft_, first_light(params, ends));
  draft_ ? hand_draft() : watcher_.hand(std::move(news));
  return {};
}

/// An estimate from known light, or else a draft. Known light is as fine as the bake, and an
/// estimate from it is there sooner than a draft, whatever the scene. Null: there is neither.
Result<std::unique_ptr<Draft>> BakeRun::first_light(const DraftParams& params,
                                                    const Progress& ends) const {
  if (!before_) return make_draft(read_->scene, settings_, params, ends);
  const ThreadLimit threads(settings_.threads);
  EstimateParams estimate = params_within(kEstimate_s, read_->scene, before_->map.texels.size());
  estimate.seed = settings_.seed;
  return estimate_light(*before_, read_->scene, estimate, ends);
}

void BakeRun::hand_draft() {
  LiveNews news;
  LiveLight& light = news.light.emplace();
  light.numbers.kind = before_ ? LiveKind::estimate : LiveKind::draft;
  light.exposure = draft_exposure_ = exposure_of(
      {draft_->scene, *draft_->tracer}, {&draft_->atlas, &draft_->map, draft_->irradiance});
  exposure_ = light.exposure;
  light.is_sudden = kept_exposure_.has_value();
  light.pages = pages_of(draft_->atlas, draft_->map, draft_->irradiance);
  light.is_without_lamps = !draft_->without_lamps.empty() && !draft_->scene.lights.empty();
  if (light.is_without_lamps) {
    light.with_lamps = std::move(light.pages);
    light.pages = pages_of(draft_->atlas, draft_->map, draft_->without_lamps);
  }
  if (!before_ || !is_before_shown_) news.lit = lit_scene(draft_->scene, draft_->atlas);
  if (!before_) news.bounced = bounces_of(*draft_);
  if (kept_exposure_) news.read = read_;
  watcher_.hand(std::move(news));
}

pipeline::BakeObserver BakeRun::observer() {
  pipeline::BakeObserver out;
  out.on_estimate = [this](const light::TexelScene& in, const light::LightEstimate& e) {
    has_light(in, e);
  };
  out.is_watched = watcher_.is_seen;
  out.on_bounce = [this](const light::TexelScene&, std::span<const Rgb> e) {
    return has_bounce(e);
  };
  if (draft_)
    out.guess = [this](const light::TexelScene& in, std::span<const Rgb> direct) {
      return with_reflections_of_draft(in, direct);
    };
  return out;
}

void BakeRun::has_light(const light::TexelScene& in, const light::LightEstimate& estimate) {
  // Light that cannot be held ends the bake with an error.
  for (const Rgb& e : estimate.irradiance)
    if (!std::isfinite(e.x + e.y + e.z)) return;
  LiveNews news;
  LiveLight& light = news.light.emplace();
  light.pages = pages_of(in.atlas, in.map, estimate.irradiance);
  light.exposure = exposure_of({in.scene, in.tracer}, {&in.atlas, &in.map, estimate.irradiance});
  exposure_ = light.exposure;
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
  if (!std::exchange(is_laid_out_, true)) {
    news.lit = lit_scene(in.scene, in.atlas);
    if (auto known = known_light(in, read_->scene)) light_ = std::move(*known);
    // After an edit there is better light than the draft's, which lies elsewhere.
    if (draft_ && !kept_exposure_) news.before = draft_elsewhere(in);
    if (draft_ && !draft_->bounced.empty()) news.bounced = bounces_of_draft(in, estimate.direct);
  }
  knows_all_ = estimate.share == 1;
  know(estimate.irradiance, estimate.direct);
  watcher_.hand(std::move(news));
}

/// True: one more is wanted.
bool BakeRun::has_bounce(std::span<const Rgb> irradiance) {
  bounced_.emplace_back(irradiance.begin(), irradiance.end());
  const size_t fit = kBouncedBytes / (irradiance.size() * sizeof(Rgb) + 1);
  return bounced_.size() <= std::min<size_t>(kMostBounces, fit);
}

/// Direct light of the bake, and reflections of the draft, as many as are soon looked up.
std::shared_ptr<const BouncedLight> BakeRun::bounces_of_draft(const light::TexelScene& in,
                                                              std::span<const Rgb> direct) const {
  const auto out = std::make_shared<BouncedLight>();
  out->is_draft = true;
  const size_t most = std::max<size_t>(kSoonLookedUp / (direct.size() + 1), 1);
  for (size_t k = 0; k < std::min(draft_->bounced.size(), most); ++k) {
    std::vector<Rgb> reflected = draft_->bounced[k];
    for (size_t i = 0; i < reflected.size(); ++i) reflected[i] = reflected[i] - draft_->direct[i];
    std::vector<Rgb> light = light_of_draft(*draft_, reflected, in);
    for (size_t i = 0; i < light.size(); ++i) light[i] = max(light[i], Rgb{}) + direct[i];
    out->after.push_back(pages_of(in.atlas, in.map, light));
  }
  return out;
}

/// As the bake has it, but for seams. It is used up.
std::shared_ptr<const BouncedLight> BakeRun::bounces_of_bake(const pipeline::Bake& baked) {
  if (bounced_.empty()) return nullptr;
  const std::vector<std::span<Rgb>> arrays(bounced_.begin(), bounced_.end());
  if (!baked.light.hidden.empty())
    post::refill_hidden(baked.atlas, baked.map, baked.light.hidden, pipeline::kRefillRings, {},
                        arrays);
  const auto out = std::make_shared<BouncedLight>();
  for (const std::vector<Rgb>& e : std::exchange(bounced_, {}))
    out->after.push_back(pages_of(baked.atlas, baked.map, e));
  return out;
}

void BakeRun::know(std::span<const Rgb> irradiance, std::span<const Rgb> direct) {
  if (!light_) return;
  light_->irradiance.assign(irradiance.begin(), irradiance.end());
  if (direct.size() == irradiance.size()) light_->direct.assign(direct.begin(), direct.end());
}

LiveLight BakeRun::draft_elsewhere(const light::TexelScene& in) const {
  LiveLight out;
  out.pages = pages_of(in.atlas, in.map, light_of_draft(*draft_, draft_->irradiance, in));
  out.exposure = draft_exposure_;
  return out;
}

/// Direct light of the bake, and reflected light of the draft.
std::vector<Rgb> BakeRun::with_reflections_of_draft(const light::TexelScene& in,
                                                    std::span<const Rgb> direct) const {
  std::vector<Rgb> reflected = draft_->irradiance;
  for (size_t i = 0; i < reflected.size(); ++i) reflected[i] = reflected[i] - draft_->direct[i];
  std::vector<Rgb> out = light_of_draft(*draft_, reflected, in);
  for (size_t i = 0; i < out.size(); ++i) out[i] = max(out[i], Rgb{}) + direct[i];
  return out;
}

void BakeRun::end(const pipeline::Bake& baked) {
  known_.kind = LiveKind::bake;
  LiveNews news;
  LiveLight& light = news.light.emplace();
  light.numbers = known_;
  light.pages = halves_of(baked.lightmaps);
  light.exposure = kept_exposure_.value_or(baked.view.exposure);
  exposure_ = light.exposure;
  light.is_last = true;
  if (!is_laid_out_) news.lit = lit_scene(baked.scene, baked.atlas);  // the solver has no estimates
  news.bounced = bounces_of_bake(baked);
  if (baked.probes)
    news.probes = std::make_shared<const ProbeBalls>(
        ProbeBalls{baked.probes->probes, baked.probes->spacing_m});
  news.warnings = baked.warnings;
  know(baked.light.irradiance, baked.light.direct);
  if (light_) {
    light_->hidden = baked.light.hidden;
    refill_hidden(light_->direct);
  }
  watcher_.hand(std::move(news));
}

/// Texels within solids get the light of those around them, as all light of the bake has it.
void BakeRun::refill_hidden(std::vector<Rgb>& light) const {
  if (light_->hidden.empty() || light.empty()) return;
  post::refill_hidden(light_->atlas, light_->map, light_->hidden, pipeline::kRefillRings, {},
                      light);
}

/// For the edits that follow.
void BakeRun::tell_lamps_apart(Progress& progress) {
  const ThreadLimit threads(settings_.threads);
  if (!light_ || !view::tell_lamps_apart({pipeline::first_direct_samples(settings_),
                                          pipeline::first_supersample(settings_), settings_.seed},
                                         *light_, progress))
    return;
  refill_hidden(light_->of_lamps);
  LiveNews news;
  if (const std::vector<Rgb> rest = light_without_lamps(*light_); !rest.empty())
    news.without_lamps = pages_of(light_->atlas, light_->map, rest);
  watcher_.hand(std::move(news));
}

/// At which the first view is readable.
float BakeRun::exposure_of(const Traced& in, const transport::TexelField& field) const {
  if (kept_exposure_) return *kept_exposure_;
  display::DrawParams params;
  params.width = kSmallWidth, params.height = kSmallHeight, params.samples_per_axis = 1;
  Progress own;  // its stage is not of the bake
  const auto picture = display::draw(
      in.scene, in.tracer, camera_,
      [&](const scene::SurfacePoint& p) { return transport::irradiance_at(field, p); }, params,
      own);
  return picture ? display::readable_exposure(*picture) : 1;
}

double BakeRun::rays_per_s(double rays) {
  const double seconds = tracing_seconds(progress_);
  const double more = rays - std::exchange(rays_before_, rays);
  const double in = seconds - std::exchange(seconds_before_, seconds);
  return in > 0 ? more / in : 0;
}

}  // namespace luxel::view
