// One bake of a scene while it is looked at: a draft of its light, and then what the bake itself
// knows, made into pictures of the lightmap.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "luxel/base/progress.h"
#include "luxel/pipeline/bake/bake_scene.h"
#include "luxel/transport/irradiance_field.h"
#include "luxel/view/live/estimate.h"
#include "luxel/view/live/live_news.h"
#include "luxel/view/read_scene.h"

namespace luxel::view {

/// Where light of a run goes, and what it is asked for.
struct RunWatcher {
  std::function<void(LiveNews)> hand;
  /// BakeObserver::is_watched.
  std::function<bool(const light::TexelScene&, size_t element)> is_seen;
};

/// All of its functions are called by one thread. Settings, watcher and progress must outlive it.
class BakeRun {
 public:
  BakeRun(const pipeline::BakeSettings& settings, const RunWatcher& watcher,
          const Progress& progress);

  /// It is a run of an edited scene: what pictures are shown at, whatever their light is; the light
  /// from which its first light follows, null where none is known; and whether what is shown is
  /// laid out as that is.
  void follow(float exposure, std::shared_ptr<const KnownLight> before, bool is_shown);
  /// Hands over a draft or an estimate, and `read` with it. Where there is none, `read` goes alone.
  /// `ends`: what cancels it. Errors: as make_draft() and estimate_light().
  Status begin(std::shared_ptr<const ReadScene> read, const DraftParams& params,
               const Progress& ends);
  /// For bake_scene() of the scene with which it began.
  pipeline::BakeObserver observer();
  /// Hands over the light of the bake that has come to its end.
  void end(const pipeline::Bake& baked);
  /// Afterwards: hands over that light but for what comes straight from lamps. Takes as long as the
  /// bake's direct light.
  void tell_lamps_apart(Progress& progress);

  /// Exposure of the newest light; nothing: there was none.
  std::optional<float> exposure() const { return exposure_; }
  /// Light that was handed over and is laid out as the bake is; null: there was none.
  std::shared_ptr<const KnownLight> known() const { return light_; }
  /// True: its first light follows from known light, and is laid out as that is.
  bool follows() const { return before_ != nullptr; }
  /// True: its light was handed over with a layout of its own.
  bool lies_anew() const { return is_laid_out_; }
  /// True: known() is made of rays of all texels.
  bool knows_all() const { return knows_all_; }

 private:
  struct Traced {
    const scene::Scene& scene;
    const trace::RayTracer& tracer;
  };
  void has_light(const light::TexelScene& in, const light::LightEstimate& estimate);
  bool has_bounce(std::span<const Rgb> irradiance);
  std::shared_ptr<const BouncedLight> bounces_of_draft(const light::TexelScene& in,
                                                       std::span<const Rgb> direct) const;
  std::shared_ptr<const BouncedLight> bounces_of_bake(const pipeline::Bake& baked);
  Result<std::unique_ptr<Draft>> first_light(const DraftParams& params, const Progress& ends) const;
  void hand_draft();
  void know(std::span<const Rgb> irradiance, std::span<const Rgb> direct);
  void refill_hidden(std::vector<Rgb>& light) const;
  LiveLight draft_elsewhere(const light::TexelScene& in) const;
  std::vector<Rgb> with_reflections_of_draft(const light::TexelScene& in,
                                             std::span<const Rgb> direct) const;
  float exposure_of(const Traced& in, const transport::TexelField& field) const;
  double rays_per_s(double rays);

  const pipeline::BakeSettings& settings_;
  const RunWatcher& watcher_;
  const Progress& progress_;
  std::optional<float> kept_exposure_, exposure_;
  std::shared_ptr<const ReadScene> read_;
  scene::Camera camera_;          ///< of the first view
  std::unique_ptr<Draft> draft_;  ///< null: there is none
  std::shared_ptr<const KnownLight> before_;
  std::shared_ptr<KnownLight> light_;
  float draft_exposure_ = 1;
  std::vector<std::vector<Rgb>> bounced_;  ///< E after 0, 1, ... reflections
  bool is_before_shown_ = false, is_laid_out_ = false, knows_all_ = false;
  LiveNumbers known_;
  double rays_before_ = 0, seconds_before_ = 0;
};

}  // namespace luxel::view
