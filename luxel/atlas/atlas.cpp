#include "luxel/atlas/atlas.h"

#include <bit>

#include "luxel/atlas/charts.h"
#include "luxel/atlas/keep_uv.h"
#include "luxel/atlas/page_modes.h"
#include "luxel/base/check.h"

namespace luxel::atlas {
namespace {

bool is_one_page(const AtlasParams& params) {
  return params.page_mode == PageMode::fixed && params.pages == 1;
}

Status check_params(const AtlasParams& params) {
  if (params.texels_per_metre < 0 || !std::isfinite(params.texels_per_metre))
    return fail(ErrorCode::bad_setting, "texels per metre {}: must be a positive number",
                params.texels_per_metre);
  if (params.resolution < 1 || params.resolution > kMaxResolution)
    return fail(ErrorCode::bad_setting, "resolution {}: must lie between 1 and {}",
                params.resolution, kMaxResolution);
  if (params.pages < 1 || params.pages > kMaxPages)
    return fail(ErrorCode::bad_setting, "pages {}: must lie between 1 and {}", params.pages,
                kMaxPages);
  if (params.pages > 1 && params.texels_per_metre > 0)
    return fail(ErrorCode::bad_setting,
                "pages {}: texels per metre {} already sets their number; leave the density out or "
                "choose automatic pages",
                params.pages, params.texels_per_metre);
  if (params.uv == UvMode::keep && !is_one_page(params))
    return fail(ErrorCode::bad_setting,
                "--uv keep: TEXCOORD_1 describes one page; leave --pages out, or --uv keep");
  LUXEL_CHECK(params.gutter >= 0 && params.max_chart_angle_rad > 0);
  return check_room(params.pages, params.resolution, params.gutter);
}

Atlas write_atlas(const scene::Scene& scene, const LaidOut& laid_out) {
  const auto& [charts, layout] = laid_out;
  Atlas atlas;
  atlas.resolution = layout.resolution;
  atlas.first_triangle = scene::first_triangles(scene);
  atlas.corners.resize(atlas.first_triangle.back());
  atlas.chart.resize(atlas.first_triangle.back());
  atlas.chart_count = uint32_t(charts.size());
  const bool several = layout.pages.size() > 1;
  if (several) atlas.pages = layout.pages, atlas.page.resize(atlas.corners.size());
  for (uint32_t c = 0; c < charts.size(); ++c)
    for (size_t i = 0; i < charts[c].faces.size(); ++i) {
      const uint32_t f = charts[c].faces[i];
      atlas.chart[f] = c;
      if (several) atlas.page[f] = layout.page[c];
      for (int k = 0; k < 3; ++k) {
        const DVec2 p = layout.texels[c][i][k];
        atlas.corners[f][k] = {float(p.x), float(p.y)};
      }
    }
  return atlas;
}

Result<Atlas> try_layout(const scene::Scene& scene, const Faces& faces,
                         const std::vector<ChartFaces>& groups, const AtlasParams& params,
                         Progress& progress) {
  LUXEL_TRY(const LaidOut laid_out, lay_out(scene, faces, groups, params, progress));
  return write_atlas(scene, laid_out);
}

/// The error for a resolution that does not work, with one that was tried and does.
Error too_small(const scene::Scene& scene, const Faces& faces,
                const std::vector<ChartFaces>& groups, AtlasParams params, Progress& progress) {
  const int wanted = params.resolution;
  for (params.resolution = 1; params.resolution <= kMaxResolution; params.resolution *= 2) {
    const PageRoom room{.side = params.resolution, .gutter = params.gutter, .count = params.pages};
    if (!holds_charts(room, groups.size())) continue;
    const Result<Atlas> atlas = try_layout(scene, faces, groups, params, progress);
    if (const Status going = stopped(progress); !going) return going.error();
    if (atlas)
      return fail(ErrorCode::bad_setting,
                  "resolution {}: too small for the scene's {} charts with {} texels between them; "
                  "the smallest power of two that works is {}",
                  wanted, atlas->chart_count, params.gutter, params.resolution)
          .error;
  }
  return fail(ErrorCode::bad_setting,
              "resolution {}: too small for the scene's {} charts, and so is the largest ({}); "
              "simplify the scene",
              wanted, groups.size(), kMaxResolution)
      .error;
}

Result<Atlas> unwrap(const scene::Scene& scene, const AtlasParams& params, Progress& progress) {
  Faces faces = make_faces(scene);
  if (!params.group.empty()) part_groups(faces, params.group);
  const std::vector<ChartFaces> groups =
      grow_charts(faces, double(params.max_chart_angle_rad), progress);
  LUXEL_TRY_STATUS(stopped(progress));
  progress.begin("packing", 1);
  Result<Atlas> atlas = try_layout(scene, faces, groups, params, progress);
  const bool small = !atlas && atlas.error().code == ErrorCode::bad_setting;
  if (small && params.texels_per_metre == 0 && params.page_mode == PageMode::fixed)
    return Failure{too_small(scene, faces, groups, params, progress)};
  return atlas;
}

}  // namespace

Result<Atlas> make_atlas(const scene::Scene& scene, const AtlasParams& params, Progress& progress) {
  LUXEL_TRY_STATUS(check_params(params));
  progress.begin("charts", 1);
  if (params.uv == UvMode::unwrap || !is_one_page(params)) return unwrap(scene, params, progress);
  Result<Atlas> kept = keep_uv1(scene, params.resolution, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  if (params.uv == UvMode::keep) {
    if (kept) return kept;
    return fail(kept.error().code, "--uv keep: {}; use --uv unwrap", kept.error().message);
  }
  if (kept) {
    LUXEL_TRY(const std::string why, why_no_layout(scene, *kept, progress));
    if (why.empty()) return kept;
  }
  return unwrap(scene, params, progress);
}

}  // namespace luxel::atlas
