// What every solver of the pipeline gets, and what it gives.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "luxel/base/part_store.h"
#include "luxel/light/light_estimate.h"
#include "luxel/light/light_layers.h"
#include "luxel/light/texel_scene.h"
#include "luxel/solve/hemicube/hemicube.h"

namespace luxel::pipeline {

class BakeCache;

/// What every solver gets.
struct SolveInput : light::TexelScene {
  PartStore* parts = nullptr;  ///< where its finished parts are kept and found; null: nowhere
  light::OnLightEstimate on_estimate{};  ///< gets gather's light as it grows
  BakeCache* cache = nullptr;  ///< what gather builds on, and where it keeps itself; null: neither
  /// Called, or not, when the solver looks at no place of an element any more: they take memory.
  std::function<void()> on_traced{};
};

/// What every solver gives.
struct TexelLight {
  std::vector<Rgb> irradiance;  ///< E per texel of the map [W/m^2]
  /// Estimated variance of its luminance per texel, the direct part aside; empty: light without
  /// noise, or noise that nobody knows.
  std::vector<float> variance;
  /// The part of the irradiance that comes straight from lamps, and its variance; empty: not apart.
  std::vector<Rgb> direct;
  std::vector<float> direct_variance;
  /// Where the solver knows how sure each texel's luminance is, relative to itself or, where it is
  /// darker, to a tenth of the mean; empty: it does not. Hidden texels have none.
  std::vector<float> errors;
  float error_p95 = 0;  ///< their 95th percentile
  /// With --layers: which there are, and E of each per texel; they add up to the irradiance.
  std::vector<light::LightLayer> layers;
  std::vector<std::vector<Rgb>> layer_irradiance;
  std::vector<uint16_t> samples;     ///< with errors: indirect rays per texel
  uint64_t rays = 0;                 ///< that were traced
  uint64_t rays_kept = 0;            ///< that an earlier bake had traced
  uint64_t supersampled_texels = 0;  ///< direct light is a mean over their points
  int sweeps = 0;
  double relative_error = 0;       ///< estimated, root mean square over the mean
  std::vector<uint8_t> hidden;     ///< per texel: 1 inside a solid, where E means nothing
  uint64_t suspicious_texels = 0;  ///< more than half of the rays met backs of one-sided surfaces
  uint64_t scratch_bytes = 0;      ///< in temporary files
  uint64_t elements = 0;           ///< of the solver's own mesh, when it has one
  std::vector<std::string> warnings;
  /// The solver's own answer, when it is not per texel.
  std::optional<hemicube::Field> field;
};

}  // namespace luxel::pipeline
