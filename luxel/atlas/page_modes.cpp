#include "luxel/atlas/page_modes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "luxel/base/parallel.h"
#include "luxel/scene/drawn_triangle.h"

namespace luxel::atlas {
namespace {

/// Charts were checked for overlap at about the density they get; here it is checked at the very
/// texels they got. Replaces the guilty ones by their parts; false, and nothing done, when there
/// are none.
bool cut_overlaps(const Faces& faces, const Layout& layout, std::vector<FlatChart>& charts) {
  std::vector<ChartFaces> away(charts.size());
  parallel_for(charts.size(), 16, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      away[c] = overlapping_faces(faces, charts[c], layout.local[c]);
  });
  if (std::all_of(away.begin(), away.end(), [](const ChartFaces& a) { return a.empty(); }))
    return false;
  std::vector<FlatChart> kept;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (away[c].empty()) {
      kept.push_back(std::move(charts[c]));
      continue;
    }
    for (ChartFaces& part : cut_out(faces, charts[c].faces, away[c]))
      kept.push_back(project_chart(faces, std::move(part)));
  }
  charts = std::move(kept);
  return true;
}

using FitCharts = std::function<Result<Layout>(const std::vector<FlatChart>&, double guess)>;

/// Places charts again while some have to be cut.
Result<LaidOut> without_overlaps(const Faces& faces, std::vector<FlatChart> charts,
                                 const FitCharts& place) {
  constexpr int kRounds = 4;  // overlap that slips past the first check is rare; twice unheard of
  double first_guess = 0;
  for (int round = 0;; ++round) {
    LUXEL_TRY(Layout layout, place(charts, first_guess));
    first_guess = 0.998 * layout.texels_per_metre;  // a few more charts change little
    if (round == kRounds || !cut_overlaps(faces, layout, charts))
      return LaidOut{std::move(charts), std::move(layout)};
  }
}

/// Side in metres of a square in which the faces would about fit. A chart that is longer would set
/// the density for all others.
double side_of(const Faces& faces, const std::vector<ChartFaces>& groups, int pages) {
  double area = 0;
  for (const ChartFaces& group : groups)
    for (const uint32_t f : group) area += faces.area[f];
  return std::sqrt(area / 0.8 / pages);
}

std::vector<uint32_t> instances_of(const scene::Scene& scene,
                                   const std::vector<FlatChart>& charts) {
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  std::vector<uint32_t> out;
  for (const FlatChart& chart : charts)
    out.push_back(scene::drawn_triangle(first, chart.faces.front()).instance);
  return out;
}

/// So many pages with as many texels as they have, or one with the texels that the density asks
/// for.
Result<LaidOut> on_fixed_pages(const scene::Scene& scene, const Faces& faces,
                               const std::vector<ChartFaces>& groups, const AtlasParams& params,
                               Progress& progress) {
  const bool dense = params.texels_per_metre > 0;
  PageRoom room{.side = dense ? kMaxResolution : params.resolution,
                .gutter = params.gutter,
                .count = params.pages};
  const double max_length = side_of(faces, groups, params.pages);
  double density = params.resolution / max_length;
  if (dense) density = std::min(double(params.texels_per_metre), kMaxResolution / max_length);
  std::vector<FlatChart> charts = flatten_charts(faces, groups, max_length, density, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  const auto place = [&](const std::vector<FlatChart>& flat, double guess) -> Result<Layout> {
    if (dense) return layout_at_density(flat, params.texels_per_metre, room, progress);
    if (room.count > 1) room.instance = instances_of(scene, flat);
    return layout_in_squares(flat, room, guess, progress);
  };
  return without_overlaps(faces, std::move(charts), place);
}

/// Triangles cannot be cut: each must lie on a page, at the density that was asked for.
Status check_lengths(const scene::Scene& scene, const std::vector<FlatChart>& charts,
                     const AtlasParams& params) {
  for (const FlatChart& chart : charts) {
    const double length_m = std::max(chart.size.x, chart.size.y);
    const double texels = length_m * double(params.texels_per_metre) + 1;
    if (texels <= params.resolution) continue;
    const uint32_t i =
        scene::drawn_triangle(scene::first_triangles(scene), chart.faces.front()).instance;
    const std::string advice =
        texels <= kMaxResolution
            ? fmt::format("raise --resolution to {}", std::bit_ceil(unsigned(std::ceil(texels))))
            : "choose a lower density";
    return fail(ErrorCode::bad_setting,
                "texels per metre {}: a surface of instance {} '{}' that cannot be cut further is "
                "{:.3g} m long, {:.0f} texels, and a page has {}; {}",
                params.texels_per_metre, i, scene.instances[i].name,
                length_m / double(scene::layout_density(scene.instances[i])), std::ceil(texels),
                params.resolution, advice);
  }
  return {};
}

/// The density is given: charts that a page cannot hold are halved first.
Result<LaidOut> on_fewest_pages(const scene::Scene& scene, const Faces& faces,
                                const std::vector<ChartFaces>& groups, const AtlasParams& params,
                                Progress& progress) {
  const double density = double(params.texels_per_metre);
  const double max_length =
      std::min(side_of(faces, groups, 1), std::max(1, params.resolution - 1) / density);
  std::vector<FlatChart> charts = flatten_charts(faces, groups, max_length, density, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  const auto place = [&](const std::vector<FlatChart>& flat, double) -> Result<Layout> {
    LUXEL_TRY_STATUS(check_lengths(scene, flat, params));
    const PageRoom room{
        .side = params.resolution, .gutter = params.gutter, .instance = instances_of(scene, flat)};
    return layout_on_fewest_pages(flat, density, room, progress);
  };
  return without_overlaps(faces, std::move(charts), place);
}

/// No density is given: more than one page only where the charts have no room on fewer.
Result<LaidOut> on_enough_pages(const scene::Scene& scene, const Faces& faces,
                                const std::vector<ChartFaces>& groups, AtlasParams params,
                                Progress& progress) {
  for (params.pages = 1; check_room(params.pages, params.resolution, params.gutter);
       ++params.pages) {
    if (params.pages > kMaxPages) break;
    const PageRoom room{.side = params.resolution, .gutter = params.gutter, .count = params.pages};
    if (!holds_charts(room, groups.size())) continue;
    Result<LaidOut> out = on_fixed_pages(scene, faces, groups, params, progress);
    if (out || out.error().code != ErrorCode::bad_setting) return out;
  }
  return fail(
      ErrorCode::bad_setting,
      "resolution {}: too small for the scene's {} charts even on {} pages; choose a higher "
      "one",
      params.resolution, groups.size(), params.pages - 1);
}

/// An instance with triangles, and what is laid out of it.
struct OwnPage {
  std::vector<ChartFaces> groups;
  double side_m = 0;
  LaidOut laid_out;
};

std::vector<OwnPage> pages_per_instance(const scene::Scene& scene, const Faces& faces,
                                        const std::vector<ChartFaces>& groups) {
  const std::vector<uint32_t> first = scene::first_triangles(scene);
  std::vector<OwnPage> pages(scene.instances.size());
  for (const ChartFaces& group : groups)
    pages[scene::drawn_triangle(first, group.front()).instance].groups.push_back(group);
  std::erase_if(pages, [](const OwnPage& page) { return page.groups.empty(); });
  for (OwnPage& page : pages) page.side_m = side_of(faces, page.groups, 1);
  return pages;
}

Result<LaidOut> on_own_page(const Faces& faces, const OwnPage& page, double density,
                            const PageRoom& room, Progress& progress) {
  std::vector<FlatChart> charts =
      flatten_charts(faces, page.groups, page.side_m, density, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  return without_overlaps(faces, std::move(charts),
                          [&](const std::vector<FlatChart>& flat, double) {
                            return layout_at_density(flat, density, room, progress);
                          });
}

/// The density at which the largest instance fills a page of the resolution.
Result<double> density_of_largest(const Faces& faces, const OwnPage& page,
                                  const AtlasParams& params, Progress& progress) {
  const PageRoom room{
      .side = params.resolution, .gutter = params.gutter, .atlas_side = kMaxMapSide};
  const std::vector<FlatChart> charts =
      flatten_charts(faces, page.groups, page.side_m, params.resolution / page.side_m, progress);
  LUXEL_TRY_STATUS(stopped(progress));
  LUXEL_TRY(const Layout layout, layout_in_squares(charts, room, 0, progress));
  return layout.texels_per_metre;
}

/// All at one density, none larger than room.side.
Status lay_out_own_pages(const Faces& faces, double density, const PageRoom& room,
                         std::vector<OwnPage>& pages, Progress& progress) {
  for (OwnPage& page : pages) {
    LUXEL_TRY(page.laid_out, on_own_page(faces, page, density, room, progress));
  }
  return {};
}

/// Own pages side by side on one atlas.
Result<LaidOut> joined(std::vector<OwnPage> pages, double density, int gutter) {
  // Where each page lies on the atlas.
  std::vector<int> sides;
  for (const OwnPage& page : pages) sides.push_back(page.laid_out.layout.resolution);
  const Arrangement arrangement = arrange_pages(sides, gutter);
  if (arrangement.side > kMaxMapSide)
    return fail(ErrorCode::bad_setting,
                "the scene's {} pages need an atlas of {} x {} texels, more than {} x {}; choose a "
                "lower density or resolution",
                pages.size(), arrangement.side, arrangement.side, kMaxMapSide, kMaxMapSide);
  // Charts move with their page; what is relative to the chart stays.
  LaidOut out;
  Layout& layout = out.layout;
  layout.resolution = arrangement.side, layout.texels_per_metre = density;
  layout.pages = arrangement.pages;
  for (uint32_t p = 0; p < pages.size(); ++p) {
    const DVec2 corner{double(layout.pages[p].x), double(layout.pages[p].y)};
    LaidOut& own = pages[p].laid_out;
    for (auto& chart : own.layout.texels) {
      for (auto& triangle : chart)
        for (DVec2& at : triangle) at = at + corner;
      layout.texels.push_back(std::move(chart));
    }
    std::move(own.layout.local.begin(), own.layout.local.end(), std::back_inserter(layout.local));
    std::move(own.charts.begin(), own.charts.end(), std::back_inserter(out.charts));
    layout.page.resize(out.charts.size(), p);
  }
  return out;
}

/// A page for each instance, all at one density: the one given, or that at which the instance with
/// the largest surface fills the resolution.
Result<LaidOut> on_page_per_instance(const scene::Scene& scene, const Faces& faces,
                                     const std::vector<ChartFaces>& groups,
                                     const AtlasParams& params, Progress& progress) {
  std::vector<OwnPage> pages = pages_per_instance(scene, faces, groups);
  if (pages.size() > size_t(kMaxPages))
    return fail(ErrorCode::bad_setting,
                "the scene has {} meshes to draw, and there are {} pages at most; choose a number "
                "of pages",
                pages.size(), kMaxPages);
  PageRoom room{.side = kMaxResolution, .gutter = params.gutter, .atlas_side = kMaxMapSide};
  double density = double(params.texels_per_metre);
  if (density > 0) {
    LUXEL_TRY_STATUS(lay_out_own_pages(faces, density, room, pages, progress));
    return joined(std::move(pages), density, params.gutter);
  }
  const auto largest =
      std::max_element(pages.begin(), pages.end(),
                       [](const OwnPage& a, const OwnPage& b) { return a.side_m < b.side_m; });
  LUXEL_TRY(density, density_of_largest(faces, *largest, params, progress));
  room.side = params.resolution;
  constexpr int kRounds = 40;  // the last at 6e-8 of the density: charts are single texels by then
  for (int round = 0; round < kRounds; density *= std::pow(0.98, ++round)) {
    // Another shape may pack worse than the largest.
    const Status done = lay_out_own_pages(faces, density, room, pages, progress);
    if (done) return joined(std::move(pages), density, params.gutter);
    if (done.error().code != ErrorCode::bad_setting) return Failure{done.error()};
  }
  return fail(ErrorCode::bad_setting,
              "resolution {}: too small for the charts of one of the scene's meshes with {} texels "
              "between them; choose a higher one",
              params.resolution, params.gutter);
}

}  // namespace

Result<LaidOut> lay_out(const scene::Scene& scene, const Faces& faces,
                        const std::vector<ChartFaces>& groups, const AtlasParams& params,
                        Progress& progress) {
  if (params.page_mode == PageMode::per_instance)
    return on_page_per_instance(scene, faces, groups, params, progress);
  if (params.page_mode == PageMode::fixed)
    return on_fixed_pages(scene, faces, groups, params, progress);
  if (params.texels_per_metre > 0) return on_fewest_pages(scene, faces, groups, params, progress);
  return on_enough_pages(scene, faces, groups, params, progress);
}

}  // namespace luxel::atlas
