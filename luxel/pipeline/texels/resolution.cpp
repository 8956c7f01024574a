#include "luxel/pipeline/texels/resolution.h"

#include <algorithm>
#include <cmath>

#include "luxel/atlas/fit_charts.h"
#include "luxel/atlas/pages.h"
#include "luxel/base/parallel.h"

namespace luxel::pipeline {
namespace {

/// Side of a page where the density says how many there are.
constexpr int kPageSide = 1024, kLargestPageSide = 4096;
constexpr int kGutter = atlas::AtlasParams{}.gutter;
/// Advice gives the packer so much more than it is thought to need: it may fall short by as much.
constexpr double kSpare = 1.2;
/// Gutters that take more of a lightmap are worth a word.
constexpr double kLowUtilisation = 0.4;

/// Layout, drawing and writing take so long per texel in scenes of many small charts [s of one
/// core].
constexpr double kFixedSecondsPerTexel = 2.5e-5;

/// The longest chart must fit a page: triangles cannot be cut.
int page_side_for(const atlas::SceneDetail& detail, double texels_per_metre) {
  double longest = 0;
  for (const atlas::ChartSize& c : detail.charts) longest = std::max(longest, c.length);
  return std::clamp(atlas::round_side_up(longest * texels_per_metre + 2), kPageSide,
                    kLargestPageSide);
}

/// The part of a lightmap's texels that take light of another chart: so few need no word, and so
/// many are worth a larger lightmap where the user leaves its size open.
constexpr double kFewBlended = 1e-3, kManyBlended = 2e-3;

double blended_part(const atlas::Atlas& atlas, const atlas::TexelMap& map) {
  return double(atlas::blended_texels(atlas, map).size()) /
         double(std::max<size_t>(1, map.texels.size()));
}

/// The part of a kept layout's texels that other charts blend in; 1 where TEXCOORD_1 cannot be kept
/// at this resolution.
Result<double> blended_part(const scene::Scene& scene, int resolution, Progress& progress) {
  atlas::AtlasParams params;
  params.uv = atlas::UvMode::keep, params.resolution = resolution;
  const Result<atlas::Atlas> atlas = atlas::make_atlas(scene, params, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  if (!atlas) return 1.0;
  return blended_part(*atlas, atlas::rasterise(scene, *atlas));
}

/// A resolution, and the part of its texels that are blended.
struct BlendedAt {
  int resolution = 0;
  double part = 0;
};

/// A layout is made for some resolution, at which its charts end between texels; at others they may
/// lie less than a texel apart. Of this resolution and the next ones up to twice as large, with no
/// more than `most` texels on a side: the first at which no more than `few` of the texels are
/// blended, else that with the fewest.
Result<int> resolution_for_uv1(const scene::Scene& scene, BlendedAt first, double most, double few,
                               Progress& progress) {
  BlendedAt best = first;
  for (int side = first.resolution; best.part > few && side < atlas::kMaxResolution;) {
    side = atlas::round_side_up(side + 1);
    if (side > 2 * first.resolution || side > most) break;
    LUXEL_TRY(const double part, blended_part(scene, side, progress));
    if (part < best.part) best = {side, part};
  }
  return best.part < 1 ? best.resolution : first.resolution;
}

/// Why a default bake has no more texels.
std::string limit_of(const SettledResolution& settled) {
  const double millions = settled.most_texels * 1e-6;
  if (settled.most_texels < kMostTexelsByDefault)
    return fmt::format("--time-budget {:g} leaves time for about {:.2g} million texels",
                       settled.settings.time_budget_s, millions);
  return fmt::format("a default bake stops at about {:.0f} million texels", millions);
}

/// Advises `density`: all charts but a fiftieth of the area are kFewestTexelsAcross wide or more.
std::string advice_for(const SettledResolution& settled, double density) {
  const double pages = double(settled.settings.pages.count);
  const double side = atlas::side_at(settled.detail, kSpare * density, kGutter) / std::sqrt(pages);
  if (settled.settings.texels_per_metre > 0 ||
      settled.settings.pages.mode != atlas::PageMode::fixed)
    return fmt::format("--texels-per-metre {:.3g} would do", density);
  if (side <= atlas::kMaxResolution)
    return fmt::format("--resolution {} would do", atlas::round_side_up(side));
  return fmt::format("--pages auto --texels-per-metre {:.3g} would do", density);
}

/// The part of the surface that lies in charts narrower than kFewestTexelsAcross.
double narrow_part(const atlas::SceneDetail& detail, double density) {
  double narrow = 0;
  for (const atlas::ChartSize& c : detail.charts)
    if (c.width * density < kFewestTexelsAcross) narrow += c.length * c.width;
  return detail.area_m2 > 0 ? narrow / detail.area_m2 : 0;
}

std::string about_gutters(const atlas::Atlas& atlas, const atlas::AtlasStats& stats) {
  if (atlas.kept || stats.utilisation >= kLowUtilisation) return {};
  return fmt::format(
      "; {:.0f} % of the lightmap is in use, because its {} charts lie {} texels apart",
      100 * stats.utilisation, stats.charts, kGutter);
}

}  // namespace

double most_texels(const BakeSettings& settings) {
  if (!(settings.time_budget_s > 0)) return kMostTexelsByDefault;
  const double seconds = 0.5 * settings.time_budget_s * double(thread_count());
  return std::min(kMostTexelsByDefault, seconds / kFixedSecondsPerTexel);
}

Result<SettledResolution> settle_resolution(const BakeSettings& settings, double most,
                                            const scene::Scene& scene, Progress& progress) {
  progress.begin("charts", 0);
  SettledResolution out{settings, {}, {}, most};
  atlas::AtlasParams params;
  params.uv = settings.uv;
  params.page_mode = settings.pages.mode, params.pages = settings.pages.count;
  LUXEL_TRY(out.detail, atlas::detail_of(scene, params, progress));
  if (settings.resolution) return out;
  const bool fixed = settings.pages.mode == atlas::PageMode::fixed;
  if (settings.texels_per_metre > 0) {
    out.settings.resolution =
        fixed ? kPageSide : page_side_for(out.detail, double(settings.texels_per_metre));
    return out;
  }
  const atlas::ChosenResolution chosen = atlas::choose_resolution(scene, out.detail, params, most);
  out.chosen = chosen;
  out.settings.resolution = chosen.resolution;
  if (chosen.uv1_area > 0) {
    LUXEL_TRY(const double part, blended_part(scene, chosen.resolution, progress));
    LUXEL_TRY(out.settings.resolution,
              resolution_for_uv1(scene, {chosen.resolution, part},
                                 std::sqrt(most / chosen.uv1_area), kManyBlended, progress));
  }
  if (fixed) return out;
  out.settings.texels_per_metre = float(chosen.texels_per_metre);
  out.settings.resolution = page_side_for(out.detail, chosen.texels_per_metre);
  return out;
}

Result<std::string> about_blended(const SettledResolution& settled, const scene::Scene& scene,
                                  const atlas::Atlas& atlas, const atlas::TexelMap& map,
                                  Progress& progress) {
  if (!atlas.kept) return std::string();
  const double part = blended_part(atlas, map);
  if (part <= kFewBlended) return std::string();
  LUXEL_TRY(const int better, resolution_for_uv1(scene, {atlas.resolution, part},
                                                 atlas::kMaxResolution, kFewBlended, progress));
  const std::string what = better != *settled.settings.resolution
                               ? fmt::format("--resolution {} would do better", better)
                               : "--uv unwrap keeps them apart";
  return fmt::format(
      "TEXCOORD_1 has charts less than a texel apart at {} x {}: {:.2g} % of the texels take light "
      "from another surface; {}",
      atlas.resolution, atlas.resolution, 100 * part, what);
}

std::string about_resolution(const SettledResolution& settled, const atlas::Atlas& atlas,
                             const atlas::AtlasStats& stats) {
  const double narrow = narrow_part(settled.detail, stats.texels_per_metre);
  const double width = atlas::narrow_width_m(settled.detail);
  // A fiftieth lies in charts of that width or narrower ones, and as little is left out of account.
  const bool fine = !(width > 0) || width * stats.texels_per_metre >= kFewestTexelsAcross;
  if (settled.chosen && settled.chosen->capped)
    return fmt::format(
        "{:.3g} texels per metre are fewer than the {:.3g} that this scene needs, because {}; {}{}",
        stats.texels_per_metre, settled.chosen->wished, limit_of(settled),
        advice_for(settled, settled.chosen->wished), about_gutters(atlas, stats));
  if (fine) return {};
  return fmt::format(
      "{:.3g} texels per metre are too few: {:.0f} % of the surface is in parts less than {} "
      "texels wide, across which light cannot vary; {}{}",
      stats.texels_per_metre, 100 * narrow, kFewestTexelsAcross,
      advice_for(settled, kFewestTexelsAcross / width), about_gutters(atlas, stats));
}

}  // namespace luxel::pipeline
