#include "luxel/atlas/choose_resolution.h"

#include <algorithm>
#include <cmath>

#include "luxel/atlas/charts.h"
#include "luxel/atlas/fit_charts.h"
#include "luxel/atlas/project.h"
#include "luxel/base/parallel.h"

namespace luxel::atlas {
namespace {

constexpr int kSmallestSide = 64;
/// Share of a page that charts fill with half their gutters, between the 0.8 of a few large charts
/// and the 1 of many small ones.
constexpr double kFilled = 0.9;
/// The area of charts that may be narrower than others: what is in them is hardly seen.
constexpr double kNarrowArea = 0.02;

/// Length of a chart in texels: slivers are shortened as fit_charts.cpp does.
double length_in_texels(const ChartSize& c, double density) {
  const double length = c.length * density, across = c.width * density;
  return std::min(length, std::max(length * std::min(1.0, 4 * across), 3.0));
}

/// Texels of all charts, each wider and longer by so many.
double sum_of(const SceneDetail& detail, double density, double border) {
  double sum = 0;
  for (const ChartSize& c : detail.charts)
    sum += (length_in_texels(c, density) + border) * (c.width * density + border);
  return sum;
}

/// The x > 0 at which a rising function reaches a value, to a thousandth; 0: it starts above.
template <class F>
double solve_rising(const F& f, double value, double x) {
  double low = x, high = x;
  for (int k = 0; k < 200 && f(high) < value; ++k) high *= 2;
  for (int k = 0; k < 200 && f(low) > value; ++k) low /= 2;
  for (int k = 0; k < 60 && high > low * 1.001; ++k) {
    const double middle = std::sqrt(low * high);
    (f(middle) > value ? high : low) = middle;
  }
  return std::sqrt(low * high);
}

/// Share of the square that TEXCOORD_1 fills; 0: it cannot be kept.
double uv1_area(const scene::Scene& scene) {
  double area = 0;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    if (mesh.uv1.empty()) return 0;
    for (const auto& t : mesh.triangles)
      area +=
          0.5 *
          std::abs(double(cross(mesh.uv1[t[1]] - mesh.uv1[t[0]], mesh.uv1[t[2]] - mesh.uv1[t[0]])));
  }
  return area <= 1 ? area : 0;
}

/// The allowed side nearest to this one, as a ratio.
int nearest_side(double side) {
  const int above = round_side_up(side);
  const bool power = (above & (above - 1)) == 0;
  const int below = power ? above / 4 * 3 : above / 3 * 2;
  return below >= kSmallestSide && side * side < double(above) * below ? below : above;
}

}  // namespace

int round_side_up(double side) {
  for (int n = kSmallestSide; n < kMaxResolution; n *= 2) {
    if (n >= side) return n;
    if (n / 2 * 3 >= side) return n / 2 * 3;
  }
  return kMaxResolution;
}

Result<SceneDetail> detail_of(const scene::Scene& scene, const AtlasParams& params,
                              Progress& progress) {
  const Faces faces = make_faces(scene);
  std::vector<ChartFaces> groups = grow_charts(faces, double(params.max_chart_angle_rad), progress);
  LUXEL_TRY_STATUS(stopped(progress));
  SceneDetail out;
  out.size_m = double(scene::world_bounds(scene).diagonal());
  out.charts.resize(groups.size());
  parallel_for(groups.size(), 64, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      double area = 0;
      for (const uint32_t f : groups[c]) area += faces.area[f];
      const FlatChart flat = project_chart(faces, std::move(groups[c]));
      const double length = std::max(flat.size.x, flat.size.y);
      out.charts[c] = {length, length > 0 ? area / length : 0};
    }
  });
  std::stable_sort(out.charts.begin(), out.charts.end(),
                   [](const ChartSize& a, const ChartSize& b) { return a.width > b.width; });
  for (const ChartSize& c : out.charts) out.area_m2 += c.length * c.width;
  return out;
}

double narrow_width_m(const SceneDetail& detail) {
  double area = 0;
  for (const ChartSize& c : detail.charts) {
    area += c.length * c.width;
    if (area >= (1 - kNarrowArea) * detail.area_m2) return c.width;
  }
  return 0;
}

double fine_density(const SceneDetail& detail) {
  if (!(detail.size_m > 0)) return 1;
  const double across = kTexelsAcross / detail.size_m, most = kMostTexelsAcross / detail.size_m;
  const double width = narrow_width_m(detail);
  return width > 0 ? std::clamp(kTexelsAcrossNarrow / width, across, most) : across;
}

double texels_at(const SceneDetail& detail, double texels_per_metre) {
  return sum_of(detail, texels_per_metre, 1);
}

double side_at(const SceneDetail& detail, double texels_per_metre, int gutter) {
  return std::sqrt(sum_of(detail, texels_per_metre, 1 + gutter) / kFilled);
}

double density_on(const SceneDetail& detail, double side, int gutter) {
  if (!(detail.area_m2 > 0)) return 1;
  return solve_rising([&](double d) { return side_at(detail, d, gutter); }, side,
                      side / std::sqrt(detail.area_m2));
}

ChosenResolution choose_resolution(const scene::Scene& scene, const SceneDetail& detail,
                                   const AtlasParams& params, double most_texels) {
  ChosenResolution out;
  out.wished = out.texels_per_metre = fine_density(detail);
  out.capped = texels_at(detail, out.wished) > most_texels;
  if (out.capped)
    out.texels_per_metre = std::min(
        out.wished,
        solve_rising([&](double d) { return texels_at(detail, d); }, most_texels, out.wished));
  const bool one_page = params.page_mode == PageMode::fixed && params.pages == 1;
  if (params.uv != UvMode::unwrap && one_page) out.uv1_area = uv1_area(scene);
  const double side =
      out.uv1_area > 0
          ? out.texels_per_metre * std::sqrt(detail.area_m2 / out.uv1_area)
          : side_at(detail, out.texels_per_metre, params.gutter) / std::sqrt(double(params.pages));
  out.resolution = nearest_side(side);
  return out;
}

}  // namespace luxel::atlas
