// Light at few texels before and after an edit, by the same few rays.
#pragma once

#include <vector>

#include "luxel/base/progress.h"
#include "luxel/light/lights.h"
#include "luxel/view/live/known_light.h"
#include "luxel/view/live/spread_texels.h"

namespace luxel::view {

/// Work that an estimate takes, in texels and rays.
struct EstimateParams {
  size_t texels = 3500;    ///< that stand for all, about
  int samples = 16;        ///< rays of each
  int direct_samples = 8;  ///< shadow rays of each towards lights with an area
  size_t sharp = 15'000;   ///< texels at most that get direct light of their own
  int sharp_samples = 16;  ///< shadow rays of those
  uint64_t seed = 1;
};

/// A scene before or after an edit.
struct SceneState {
  const scene::Scene& scene;
  const trace::RayTracer& tracer;
  const light::Lights& lights;
};

/// E per cell of spread texels [W/m^2].
struct Estimates {
  std::vector<Rgb> direct_before, direct_after;
  std::vector<Rgb> area_before, area_after;  ///< the part of `direct` that is not of lamps
  std::vector<Rgb> reflected_before, reflected_after;  ///< all but what is direct, soft sky too
  /// 1: within a solid. After the edit such cells have light of those beside them.
  std::vector<uint8_t> hidden_before, hidden_after;
};

/// Rays are cosine-distributed, and read what is known where they end. Their light after the edit
/// has all bounces: a texel that they meet has what is known times what the estimates change in its
/// cell. What light is scattered through (KHR_materials_diffuse_transmission) does not change.
/// Errors: no memory; cancelled.
Result<Estimates> light_by_few_rays(const KnownLight& known, const SceneState& before,
                                    const SceneState& after, const SpreadTexels& spread,
                                    const EstimateParams& params, const Progress& watched);

/// Known light times the estimated change, `after` over `before`. Larger factors than kMostFactor
/// are those of noise: then it is `after` itself.
Rgb scaled(Rgb known, Rgb before, Rgb after);
inline constexpr float kMostFactor = 3;

/// Some texels as a map, for what works on all texels of one.
atlas::TexelMap map_of_chosen(const atlas::TexelMap& map, std::span<const uint32_t> chosen);

}  // namespace luxel::view
