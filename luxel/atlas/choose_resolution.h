// Resolution of a scene's lightmap, chosen by the detail that there is to see.
#pragma once

#include <vector>

#include "luxel/atlas/atlas.h"

namespace luxel::atlas {

/// A chart as a rectangle of its area and its longest side [m].
struct ChartSize {
  double length = 0, width = 0;
};

/// Sizes that decide how many texels a scene needs.
struct SceneDetail {
  double size_m = 0;              ///< diagonal of the bounds
  double area_m2 = 0;             ///< of all charts
  std::vector<ChartSize> charts;  ///< widest first
};

/// Charts grown as for unwrapping; groups do not matter. Errors: cancelled.
Result<SceneDetail> detail_of(const scene::Scene& scene, const AtlasParams& params,
                              Progress& progress);

/// Width of the narrowest charts that count [m]: those that are wider have all but a fiftieth of
/// the area. 0 without surfaces.
double narrow_width_m(const SceneDetail& detail);

/// The density [texels/m] at which all is seen that a picture of the scene shows: kTexelsAcross
/// over its diagonal, or more where surfaces are narrow, up to kMostTexelsAcross.
double fine_density(const SceneDetail& detail);
inline constexpr double kTexelsAcross = 512, kMostTexelsAcross = 1024;
/// Texels across the narrowest charts that count.
inline constexpr double kTexelsAcrossNarrow = 4;

/// Texels that charts touch at a density, about.
double texels_at(const SceneDetail& detail, double texels_per_metre);
/// Side of the square that charts and their gutters fill at a density, about: the packer comes
/// within a few percent.
double side_at(const SceneDetail& detail, double texels_per_metre, int gutter);
/// The density that charts get on a square, about: the inverse of side_at().
double density_on(const SceneDetail& detail, double side, int gutter);

/// A resolution with its reason.
struct ChosenResolution {
  int resolution = 0;           ///< side of a page: a power of two, or one and a half times that
  double texels_per_metre = 0;  ///< about what charts will get
  double wished = 0;            ///< fine_density()
  bool capped = false;          ///< the wished one needs more texels than `most_texels`
  double uv1_area = 0;          ///< share of the square that TEXCOORD_1 fills; 0: it cannot be kept
};

/// The resolution of params.pages pages at which the density is about fine_density(), with no more
/// than about `most_texels` texels. Where TEXCOORD_1 may be kept, by the area that it fills. For
/// pages that are not fixed only the density counts.
ChosenResolution choose_resolution(const scene::Scene& scene, const SceneDetail& detail,
                                   const AtlasParams& params, double most_texels);

/// The smallest side from 64 to 16384, a power of two or one and a half times that, which is no
/// smaller than `side`.
int round_side_up(double side);

}  // namespace luxel::atlas
