// The resolution of a bake: as asked for, or by the scene.
#pragma once

#include <optional>
#include <string>

#include "luxel/atlas/choose_resolution.h"
#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/pipeline/settings/settings.h"

namespace luxel::pipeline {

/// A bake gets about so many texels where its user leaves the resolution open: they take a minute
/// or a few and some 1 GB.
inline constexpr double kMostTexelsByDefault = 2e6;
/// The limit of a bake: that, or with a time budget so many that all but light takes half of the
/// time at most.
double most_texels(const BakeSettings& settings);

/// Settings that say how large lightmaps are, and what there is to see in the scene.
struct SettledResolution {
  BakeSettings settings;  ///< with a resolution
  atlas::SceneDetail detail;
  std::optional<atlas::ChosenResolution> chosen;  ///< where the user has left it open
  double most_texels = 0;                         ///< that it was chosen with
};

/// Settles what the user has left open: the resolution of pages whose number is given, the density
/// of others, with about `most` texels at most. Where TEXCOORD_1 may be kept, its charts lie a
/// texel apart at that resolution, if there is such a one up to twice as large. Errors: cancelled.
Result<SettledResolution> settle_resolution(const BakeSettings& settings, double most,
                                            const scene::Scene& scene, Progress& progress);

/// One sentence where a kept TEXCOORD_1 has charts so close together that look-ups blend one's
/// light into the other, with what to do. Empty: all is well. Errors: cancelled.
Result<std::string> about_blended(const SettledResolution& settled, const scene::Scene& scene,
                                  const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                  Progress& progress);

/// One sentence where light is coarser than the scene deserves, with what to do: more than a
/// fiftieth of the surface lies in charts less than kFewestTexelsAcross wide, or the default
/// stopped at most_texels. Empty: all is well.
std::string about_resolution(const SettledResolution& settled, const atlas::Atlas& atlas,
                             const atlas::AtlasStats& stats);
/// Light cannot vary across a narrower chart.
inline constexpr double kFewestTexelsAcross = 2;

}  // namespace luxel::pipeline
