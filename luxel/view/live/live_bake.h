// A bake that is looked at while it is made: a thread bakes, and hands over what it has by then.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/image/half.h"
#include "luxel/pipeline/settings/settings.h"
#include "luxel/view/lit_scene.h"
#include "luxel/view/read_scene.h"

namespace luxel::view {

/// What light is made of.
enum class LiveKind : uint8_t {
  draft,                 ///< coarse, see draft.h
  direct_and_draft,      ///< sharp direct light, and reflections of the draft
  direct_and_even_rest,  ///< sharp direct light and an ambient term
  partly,                ///< the bake's in part, elsewhere one of the two above
  bake,                  ///< all of it the bake's
};

/// How well light is known.
struct LiveNumbers {
  LiveKind kind = LiveKind::bake;
  double share = 1;       ///< LightEstimate::share
  double samples = 0;     ///< rays per texel, traced by now
  float error_p95 = 0;    ///< LightEstimate::error_p95
  double error_rms = 0;   ///< LightEstimate::error_rms
  double rays_per_s = 0;  ///< of the last round; 0: not known
};

/// Light as far as it is known.
struct LiveLight {
  std::vector<image::HalfImage> pages;  ///< E [W/m^2], of sizes that do not change
  float exposure = 1;                   ///< at which the first view is readable
  LiveNumbers numbers;
  bool is_last = false;  ///< what `luxel bake` writes
};

/// What has come since it was last asked for.
struct LiveNews {
  std::shared_ptr<const ReadScene> read;  ///< once, first
  /// With the first light: of a draft, and then of the bake itself, which lies elsewhere.
  std::optional<LitScene> lit;
  std::optional<LiveLight> light;  ///< the newest
  /// With `lit`, where something else was shown before: its light where `lit` has its own.
  std::optional<LiveLight> before;
  std::vector<std::string> warnings;  ///< pipeline::Bake::warnings, with the last light
  std::optional<std::string> said;    ///< of saving, or why there is no light; a sentence
};

/// The state of the work.
enum class LiveState : uint8_t { baking, paused, baked, failed };

/// Guards the thread. Its functions are called by one thread and do not wait for the bake, but for
/// the destructor, which ends it within about 0.2 s.
class LiveBake {
 public:
  /// Begins to bake settings.scene. It must be called from the thread that calls the others.
  static std::unique_ptr<LiveBake> begin(const pipeline::BakeSettings& settings);
  virtual ~LiveBake() = default;

  virtual LiveNews take() = 0;
  /// Light of what this camera sees, in a picture of that aspect (width / height), comes first.
  virtual void look(const scene::Camera& camera, float aspect) = 0;
  virtual LiveState state() const = 0;
  virtual Progress::Snapshot snapshot() const = 0;
  virtual void pause(bool is_paused) = 0;
  /// Writes the files of `luxel bake` into settings.output, in the background; take() tells the
  /// end. Only once it is baked.
  virtual void save() = 0;
  /// Returns when the bake has ended, well or not, and is saved if it was asked for.
  virtual void wait() = 0;
};

}  // namespace luxel::view
