// View factors: every row of the exact table, by each method.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/validation.h"
#include "luxel/base/file.h"
#include "luxel/base/parallel.h"
#include "luxel/base/text_tables.h"
#include "luxel/export/plot.h"
#include "luxel/validate/prepared.h"
#include "luxel/viewfactor/point_form_factor.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/visible_form_factor.h"

namespace luxel::bench {
namespace {

using viewfactor::Polygon;

struct Row {
  std::string name, note;
  bool is_point = false;
  Polygon a, b;
  DVec3 normal;  ///< of the point a[0]
  std::vector<Polygon> blockers;
  double exact = 0;
};

Result<Row> read_row(const TextRow& cells) {
  if (cells.size() < 8) return fail(ErrorCode::bad_input, "it has fewer than 8 cells");
  Row row;
  row.name = cells[0], row.note = cells[7], row.is_point = cells[1] == "point";
  LUXEL_TRY(row.a, parse_polygon(cells[2]));
  LUXEL_TRY(row.b, parse_polygon(cells[3]));
  LUXEL_TRY(row.blockers, parse_polygons(cells[4]));
  LUXEL_TRY(row.exact, parse_number(cells[5]));
  if (row.is_point && row.a.size() != 2)
    return fail(ErrorCode::bad_input, "a point needs its place and its normal");
  if (row.is_point) row.normal = row.a[1];
  return row;
}

Result<std::vector<Row>> read_rows(std::string_view csv, const std::filesystem::path& file) {
  std::vector<Row> rows;
  for (const TextRow& cells : csv_rows(csv)) {
    Result<Row> row = read_row(cells);
    if (!row)
      return fail(ErrorCode::bad_input, "{}: row '{}': {}", file.string(), cells[0],
                  row.error().message);
    rows.push_back(std::move(*row));
  }
  return rows;
}

double analytic(const Row& row) {
  if (row.is_point) return viewfactor::point_to_polygon(row.a[0], row.normal, row.b);
  return viewfactor::form_factor(row.a, row.b, row.blockers, 1e-5).value;
}

Result<double> sampled(const Row& row, const viewfactor::SampledParams& params) {
  LUXEL_TRY(const viewfactor::SampledFactor f,
            row.is_point ? viewfactor::sampled_point_factor(row.a[0], row.normal, row.b,
                                                            row.blockers, params)
                         : viewfactor::sampled_form_factor(row.a, row.b, row.blockers, params));
  return f.value;
}

/// Relative, or absolute where the exact factor is 0.
double error_of(double value, const Row& row) {
  return row.exact > 0 ? std::abs(value - row.exact) / row.exact : std::abs(value);
}

std::string scientific_error(double error) {
  return error == 0 ? "0" : error < 1e-15 ? "< 1e-15" : fmt::format("{:.1e}", error);
}

using Points = std::vector<std::array<double, 2>>;  ///< (rays per factor, error)

/// Root mean square of the relative errors: of rays over the polygon rows with F >= 0.02, of
/// hemicubes over the point rows (between points of a surface, hemicubes are no better than rays).
Result<Points> measure_rate(const std::vector<Row>& rows,
                            const std::vector<viewfactor::SampledParams>& steps) {
  Points points;
  for (const viewfactor::SampledParams& params : steps) {
    const bool hemicube = params.hemicube > 0;
    double sum = 0, count = 0;
    for (const Row& row : rows) {
      if (row.is_point != hemicube || (!hemicube && row.exact < 0.02)) continue;
      LUXEL_TRY(const double value, sampled(row, params));
      sum += error_of(value, row) * error_of(value, row), ++count;
    }
    const double rays = hemicube ? 3.0 * params.hemicube * params.hemicube : double(params.samples);
    points.push_back({rays, std::sqrt(sum / count)});
  }
  return points;
}

/// Slope of a least-squares line in the double-logarithmic plot.
double slope(const Points& points) {
  double mx = 0, my = 0, sxx = 0, sxy = 0;
  const double n = double(points.size());
  for (const auto& [x, y] : points) mx += std::log(x) / n, my += std::log(y) / n;
  for (const auto& [x, y] : points) {
    sxx += (std::log(x) - mx) * (std::log(x) - mx);
    sxy += (std::log(x) - mx) * (std::log(y) - my);
  }
  return sxy / sxx;
}

/// Unoccluded pairs per second on one thread.
double pairs_per_second(const std::vector<Row>& rows) {
  const ThreadLimit one(1);
  const auto start = Clock::now();
  int pairs = 0;
  double sum = 0;
  while (seconds_since(start) < 1) {
    for (const Row& row : rows)
      if (!row.is_point && row.blockers.empty())
        sum += viewfactor::polygon_form_factor(row.a, row.b), ++pairs;
  }
  return sum > 0 ? pairs / seconds_since(start) : 0;
}

constexpr viewfactor::SampledParams kHemicubeCheck{.samples = 64, .hemicube = 128};
constexpr viewfactor::SampledParams kRaysCheck{.samples = 1u << 18};

struct RowErrors {
  std::vector<std::vector<std::string>> rows;
  double open = 0, blocked = 0;  ///< largest errors of the analytic method
  nlohmann::json json = nlohmann::json::array();
};

Result<RowErrors> measure_rows(const std::vector<Row>& rows, const Progress& progress) {
  RowErrors table;
  for (const Row& row : rows) {
    LUXEL_TRY_STATUS(stopped(progress));
    const double a = error_of(analytic(row), row);
    LUXEL_TRY(const double hemicube, sampled(row, kHemicubeCheck));
    LUXEL_TRY(const double rays, sampled(row, kRaysCheck));
    double& largest = row.blockers.empty() ? table.open : table.blocked;
    largest = std::max(largest, a);
    const double h = error_of(hemicube, row), r = error_of(rays, row);
    table.rows.push_back({row.name, row.note, fmt::format("{:.12g}", row.exact),
                          scientific_error(a), scientific_error(h), scientific_error(r)});
    table.json.push_back({{"case", row.name},
                          {"exact", row.exact},
                          {"analytic_error", a},
                          {"hemicube_error", h},
                          {"rays_error", r}});
  }
  return table;
}

}  // namespace

Result<Section> validate_view_factors(const std::filesystem::path& shared, Progress& progress) {
  Section section;
  section.markdown = "## View factors against closed forms\n\n";
  const std::filesystem::path file = shared / "reference" / "view-factors.csv";
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  // All rows of the exact table by all methods.
  LUXEL_TRY(const std::vector<Row> rows,
            read_rows({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file));
  progress.begin("view factors", 0);
  LUXEL_TRY(const RowErrors table, measure_rows(rows, progress));
  // Errors against the number of rays.
  std::vector<viewfactor::SampledParams> hemicubes, rays;
  for (const int n : {8, 16, 32, 64, 128, 256, 512})
    hemicubes.push_back({.samples = 1, .hemicube = n});
  for (const uint32_t n : {8u, 10u, 12u, 14u, 16u, 18u}) rays.push_back({.samples = 1u << n});
  LUXEL_TRY(const Points hemicube_rate, measure_rate(rows, hemicubes));
  LUXEL_TRY(const Points ray_rate, measure_rate(rows, rays));
  const double speed = pairs_per_second(rows);
  export_::Plot plot;
  plot.title = "View factors: error against rays";
  plot.x_label = "rays per factor";
  plot.y_label = "relative error, root mean square";
  plot.log_x = plot.log_y = true;
  plot.series = {
      {fmt::format("rays, slope {:.2f}", slope(ray_rate)), ray_rate},
      {fmt::format("hemicube over a point, slope {:.2f}", slope(hemicube_rate)), hemicube_rate}};
  section.files.push_back(svg_file("view-factors.svg", export_::svg(plot)));
  section.markdown += fmt::format(
      "`luxel factors` computes F(A -> B), the fraction of the radiation from A that reaches B. "
      "The table has all {} rows of the exact table, by three methods: analytic (contour integral; "
      "adaptive where there are blockers, asked for 1e-5), hemicubes of {} pixels on {} points, {} "
      "rays. Errors are relative, or absolute where F is 0. Largest analytic error: **{:.1e}** "
      "without blockers (goal 1e-6), **{:.1e}** with blockers (goal 1e-4). Speed without blockers: "
      "{:.0f} pairs per second on one thread (goal 1000).\n\n"
      "{}\n"
      "{}\n\n"
      "- Rays: root mean square over the {} rows of two polygons with F >= 0.02. The expected "
      "power is -0.5 or a little better, because points and directions are stratified.\n"
      "- Hemicubes: root mean square over the {} rows of a point, by one hemicube with n = 8 to "
      "512 pixels along its edge. Only pixels on outlines are wrong, so the expected error falls "
      "as n^-1.5, the power -0.75 of the rays. Over the points of a surface, the error of "
      "hemicubes falls like that of rays.\n",
      rows.size(), kHemicubeCheck.hemicube, kHemicubeCheck.samples, kRaysCheck.samples, table.open,
      table.blocked, speed,
      markdown_table({"case", "", "exact F", "analytic", "hemicube", "rays"}, table.rows),
      show(section.files.back(), "Error of sampled view factors against the number of rays"),
      std::count_if(rows.begin(), rows.end(),
                    [](const Row& r) { return r.exact >= 0.02 && !r.is_point; }),
      std::count_if(rows.begin(), rows.end(), [](const Row& r) { return r.is_point; }));
  section.json = {{"rows", table.json},
                  {"largest_error_open", table.open},
                  {"largest_error_blocked", table.blocked},
                  {"pairs_per_second", speed},
                  {"rays_slope", slope(ray_rate)},
                  {"hemicube_slope", slope(hemicube_rate)}};
  return section;
}

}  // namespace luxel::bench
