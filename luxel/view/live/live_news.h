// News of a bake that is looked at, collected until somebody asks for them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "luxel/image/half.h"
#include "luxel/view/lit_scene.h"
#include "luxel/view/model/bounced_light.h"
#include "luxel/view/model/probe_balls.h"
#include "luxel/view/read_scene.h"

namespace luxel::view {

/// Kinds of light, by the way it was computed.
enum class LiveKind : uint8_t {
  draft,                 ///< coarse, see draft.h
  estimate,              ///< after an edit, see estimate.h
  direct_and_draft,      ///< sharp direct light, and reflections of the draft
  direct_and_even_rest,  ///< sharp direct light and an ambient term
  partly,                ///< the bake's in part, elsewhere one of the two above
  bake,                  ///< all of it the bake's
};

/// Quality of the light so far.
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
  bool is_last = false;           ///< what `luxel bake` writes
  bool is_sudden = false;         ///< it does not fade in: the scene was edited
  bool is_without_lamps = false;  ///< what comes straight from lamps is to be drawn besides
  std::vector<image::HalfImage> with_lamps;  ///< then: all of it
};

/// News since the last take().
struct LiveNews {
  std::shared_ptr<const ReadScene> read{};  ///< of the file, and after each edit
  /// With the first light: of a draft, and then of the bake itself, which lies elsewhere.
  std::optional<LitScene> lit{};
  std::optional<LiveLight> light{};  ///< the newest
  /// With `lit`, where something else was shown before: its light where `lit` has its own.
  std::optional<LiveLight> before{};
  /// The last light of a bake, but for what comes straight from lamps: is shown as soon as
  /// something is edited, with lamps drawn besides. It comes after that light.
  std::vector<image::HalfImage> without_lamps{};
  /// The newest light reflection by reflection, as far as it is known; laid out as it is.
  std::shared_ptr<const BouncedLight> bounced{};
  std::shared_ptr<const ProbeBalls> probes{};  ///< of a bake with --probes, with the last light
  std::vector<std::string> warnings{};         ///< pipeline::Bake::warnings, with the last light
  std::optional<std::string> said{};           ///< of saving, or why there is no light; a sentence
};

/// Newer news take the place of older ones.
void merge(LiveNews newer, LiveNews& news);

}  // namespace luxel::view
