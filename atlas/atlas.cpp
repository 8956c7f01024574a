#include "atlas/atlas.h"

#include <bit>

#include "atlas/charts.h"
#include "atlas/keep_uv.h"
#include "atlas/layout.h"
#include "base/check.h"

namespace luxel::atlas {
namespace {

tl::unexpected<Error> cancelled() { return fail(ErrorCode::cancelled, "cancelled"); }

Status check_params(const AtlasParams& params) {
  if (params.texels_per_metre < 0 || !std::isfinite(params.texels_per_metre))
    return fail(ErrorCode::bad_setting, "texels per metre {}: must be a positive number",
                params.texels_per_metre);
  if (params.resolution < 1 || params.resolution > kMaxResolution)
    return fail(ErrorCode::bad_setting, "resolution {}: must lie between 1 and {}",
                params.resolution, kMaxResolution);
  LUXEL_CHECK(params.gutter >= 0 && params.max_chart_angle_rad > 0);
  return {};
}

Result<Layout> layout_charts(const std::vector<FlatChart>& charts, const AtlasParams& params,
                             double first_guess, Progress& progress) {
  if (params.texels_per_metre > 0)
    return layout_at_density(charts, params.texels_per_metre, params.gutter, progress);
  return layout_in_square(charts, params.resolution, params.gutter, first_guess, progress);
}

/// Charts were checked for overlap at about the density they get; here it is checked at the very
/// texels they got. Replaces the guilty ones by their parts; false when there are none.
bool cut_overlaps(const Faces& faces, const Layout& layout, std::vector<FlatChart>& charts) {
  std::vector<FlatChart> kept;
  bool cut = false;
  for (size_t c = 0; c < charts.size(); ++c) {
    const ChartFaces away = overlapping_faces(faces, charts[c], layout.local[c]);
    if (away.empty()) {
      kept.push_back(std::move(charts[c]));
      continue;
    }
    cut = true;
    for (ChartFaces& part : cut_out(faces, charts[c].faces, away))
      kept.push_back(project_chart(faces, std::move(part)));
  }
  charts = std::move(kept);
  return cut;
}

Atlas write_atlas(const scene::Scene& scene, const std::vector<FlatChart>& charts,
                  const Layout& layout) {
  Atlas atlas;
  atlas.resolution = layout.resolution;
  atlas.first_triangle = scene::first_triangles(scene);
  atlas.corners.resize(atlas.first_triangle.back());
  atlas.chart.resize(atlas.first_triangle.back());
  atlas.chart_count = uint32_t(charts.size());
  for (uint32_t c = 0; c < charts.size(); ++c)
    for (size_t i = 0; i < charts[c].faces.size(); ++i) {
      const uint32_t f = charts[c].faces[i];
      atlas.chart[f] = c;
      for (int k = 0; k < 3; ++k) {
        const DVec2 p = layout.texels[c][i][k];
        atlas.corners[f][k] = {float(p.x), float(p.y)};
      }
    }
  return atlas;
}

/// Flattens and lays out at one resolution or density.
Result<Atlas> try_layout(const scene::Scene& scene, const Faces& faces,
                         const std::vector<ChartFaces>& groups, const AtlasParams& params,
                         Progress& progress) {
  double area = 0;
  for (const double a : faces.area) area += a;
  // A chart longer than the square that holds everything would set the density for all others.
  const double max_length = std::sqrt(area / 0.8);
  double density = params.resolution / max_length;
  if (params.texels_per_metre > 0)
    density = std::min(double(params.texels_per_metre), kMaxResolution / max_length);
  std::vector<FlatChart> charts = flatten_charts(faces, groups, max_length, density, progress);
  if (progress.cancelled()) return cancelled();
  constexpr int kRounds = 4;  // overlap that slips past the first check is rare; twice unheard of
  double first_guess = 0;
  for (int round = 0;; ++round) {
    LUXEL_TRY(const Layout layout, layout_charts(charts, params, first_guess, progress));
    first_guess = 0.998 * layout.texels_per_metre;  // a few more charts change little
    if (round == kRounds || !cut_overlaps(faces, layout, charts))
      return write_atlas(scene, charts, layout);
  }
}

/// The error for a resolution that does not work, with one that was tried and does.
Error too_small(const scene::Scene& scene, const Faces& faces,
                const std::vector<ChartFaces>& groups, AtlasParams params, Progress& progress) {
  const int wanted = params.resolution;
  for (params.resolution = 1; params.resolution <= kMaxResolution; params.resolution *= 2) {
    if (!holds_charts(params.resolution, groups.size(), params.gutter)) continue;
    const Result<Atlas> atlas = try_layout(scene, faces, groups, params, progress);
    if (progress.cancelled()) return cancelled().value();
    if (atlas)
      return fail(ErrorCode::bad_setting,
                  "resolution {}: too small for the scene's {} charts with {} texels between them; "
                  "the smallest power of two that works is {}",
                  wanted, atlas->chart_count, params.gutter, params.resolution)
          .value();
  }
  return fail(ErrorCode::bad_setting,
              "resolution {}: too small for the scene's {} charts, and so is the largest ({}); "
              "simplify the scene",
              wanted, groups.size(), kMaxResolution)
      .value();
}

Result<Atlas> unwrap(const scene::Scene& scene, const AtlasParams& params, Progress& progress) {
  Faces faces = make_faces(scene);
  if (!params.group.empty()) part_groups(faces, params.group);
  const std::vector<ChartFaces> groups =
      grow_charts(faces, double(params.max_chart_angle_rad), progress);
  if (progress.cancelled()) return cancelled();
  progress.begin("packing", 1);
  Result<Atlas> atlas = try_layout(scene, faces, groups, params, progress);
  const bool small = !atlas && atlas.error().code == ErrorCode::bad_setting;
  if (small && params.texels_per_metre == 0)
    return tl::unexpected(too_small(scene, faces, groups, params, progress));
  return atlas;
}

}  // namespace

Result<Atlas> make_atlas(const scene::Scene& scene, const AtlasParams& params, Progress& progress) {
  LUXEL_TRY_STATUS(check_params(params));
  progress.begin("charts", 1);
  if (params.uv != UvMode::unwrap) {
    Result<Atlas> kept = keep_uv1(scene, params.resolution, progress);
    if (kept || params.uv == UvMode::keep || kept.error().code == ErrorCode::cancelled) return kept;
  }
  return unwrap(scene, params, progress);
}

}  // namespace luxel::atlas
