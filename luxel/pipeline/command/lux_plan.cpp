#include "luxel/pipeline/command/lux_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "luxel/image/text.h"
#include "luxel/image/value_scale.h"

namespace luxel::pipeline {
namespace {

using image::Color8;
using image::Image8;

/// The longer side of a plan, its frame, and the band above it that says what it shows [pixels].
constexpr int kPlanSide = 760, kFrame = 14, kHeading = 44, kScaleBand = 26;
constexpr Color8 kPaperColor{255, 255, 255}, kInkColor{20, 20, 20}, kEmpty{232, 232, 232};
constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

/// Where a floor lies in its plan.
struct PlanView {
  const LitFloor& lit;
  double pixels_per_m = 1;
  int width = 0, height = 0;

  double x_of(int pixel) const { return lit.floor.x0 + (pixel + 0.5) / pixels_per_m; }
  double z_of(int pixel) const { return lit.floor.z0 + (pixel + 0.5) / pixels_per_m; }
  int column_of(double x) const { return int(std::floor((x - lit.floor.x0) * pixels_per_m)); }
  int row_of(double z) const { return int(std::floor((z - lit.floor.z0) * pixels_per_m)); }
};

PlanView view_of(const LitFloor& lit) {
  const Floor& f = lit.floor;
  const double scale = kPlanSide / std::max({f.x1 - f.x0, f.z1 - f.z0, 1e-6});
  return {lit, scale, std::max(1, int((f.x1 - f.x0) * scale + 0.5)),
          std::max(1, int((f.z1 - f.z0) * scale + 0.5))};
}

/// E of each pixel, not finite where its cell has no point; and the room of each.
struct PlanValues {
  std::vector<float> value;
  std::vector<uint32_t> room;
};

PlanValues values_of(const PlanView& view) {
  const Floor& floor = view.lit.floor;
  std::vector<size_t> at(size_t(floor.columns) * size_t(floor.rows), SIZE_MAX);
  for (size_t i = 0; i < floor.points.size(); ++i)
    at[size_t(floor.points[i].row) * size_t(floor.columns) + size_t(floor.points[i].column)] = i;
  const auto point = [&](int column, int row) {
    const bool inside = column >= 0 && row >= 0 && column < floor.columns && row < floor.rows;
    return inside ? at[size_t(row) * size_t(floor.columns) + size_t(column)] : SIZE_MAX;
  };
  PlanValues out;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const double u = (view.x_of(x) - floor.x0) / floor.cell_x();
      const double v = (view.z_of(y) - floor.z0) / floor.cell_z();
      const size_t own = point(int(std::floor(u)), int(std::floor(v)));
      out.value.push_back(kNotANumber), out.room.push_back(scene::kNone);
      if (own == SIZE_MAX) continue;
      const uint32_t room = out.room.back() = floor.points[own].room;
      const int c0 = int(std::floor(u - 0.5)), r0 = int(std::floor(v - 0.5));
      const double fu = u - 0.5 - c0, fv = v - 0.5 - r0;
      double sum = 0, weight = 0;
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          const size_t k = point(c0 + i, r0 + j);
          if (k == SIZE_MAX || floor.points[k].room != room) continue;
          const double w = (i ? fu : 1 - fu) * (j ? fv : 1 - fv);
          sum += w * double(view.lit.illuminance[k]), weight += w;
        }
      out.value.back() = float(sum / weight);
    }
  return out;
}

void put(Image8& picture, int x, int y, Color8 color) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  std::copy(color.begin(), color.end(),
            picture.data.begin() + 3 * (std::ptrdiff_t(y) * picture.width + x));
}

/// A line of two pixels' width.
void draw_wall(Image8& picture, double x0, double y0, double x1, double y1) {
  const int steps = std::max(1, int(std::ceil(std::max(std::abs(x1 - x0), std::abs(y1 - y0)))));
  if (steps > 1 << 15) return;
  for (int k = 0; k <= steps; ++k) {
    const double t = double(k) / steps;
    const int x = int(std::floor(x0 + (x1 - x0) * t)), y = int(std::floor(y0 + (y1 - y0) * t));
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) put(picture, x - i, y - j, kInkColor);
  }
}

/// Draws the lines in which the plane at height y cuts the scene's triangles.
void draw_walls(const scene::Scene& scene, const PlanView& view, double y, Image8& picture) {
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      const scene::Triangle3 t = scene::world_triangle(scene, i, k);
      const std::array<Vec3, 3> corner{t.a, t.b, t.c};
      std::array<std::array<double, 2>, 2> ends{};
      size_t found = 0;
      for (size_t c = 0; c < 3 && found < 2; ++c) {
        const Vec3 p = corner[c], q = corner[(c + 1) % 3];
        const double a = double(p.y) - y, b = double(q.y) - y;
        if ((a < 0) == (b < 0)) continue;
        const double s = a / (a - b);
        ends[found++] = {double(p.x) + s * double(q.x - p.x), double(p.z) + s * double(q.z - p.z)};
      }
      if (found < 2) continue;
      const auto column = [&](double x) { return (x - view.lit.floor.x0) * view.pixels_per_m; };
      const auto row = [&](double z) { return (z - view.lit.floor.z0) * view.pixels_per_m; };
      draw_wall(picture, column(ends[0][0]), row(ends[0][1]), column(ends[1][0]), row(ends[1][1]));
    }
  }
}

/// A mark of the smallest and the largest value is worth more than their numbers alone.
void mark_extremes(const PlanView& view, Image8& picture, std::vector<std::array<int, 2>>& taken) {
  if (!(view.lit.all.maximum > view.lit.all.minimum)) return;
  for (const auto& [name, at, value] :
       {std::tuple{"min", view.lit.all.minimum_at, view.lit.all.minimum},
        std::tuple{"max", view.lit.all.maximum_at, view.lit.all.maximum}}) {
    const std::string text = fmt::format("{} {:.3g}", name, value);
    const int half = image::text_width(text, 1) / 2 + 3;
    const int x = std::clamp(view.column_of(double(at.x)), half, std::max(half, view.width - half));
    const int y = std::clamp(view.row_of(double(at.z)), 8, std::max(8, view.height - 8));
    image::draw_label(picture, x, y, text);
    taken.push_back({x, y});
  }
}

/// A line of a round length, and how long it is.
void draw_scale_bar(const PlanView& view, Image8& picture, int x, int y) {
  double metres = 1;
  while (metres * view.pixels_per_m > 0.4 * view.width) metres *= 0.1;
  while (metres * 10 * view.pixels_per_m < 0.4 * view.width) metres *= 10;
  const int length = std::max(1, int(metres * view.pixels_per_m));
  for (int k = 0; k < length; ++k)
    for (int j = 0; j < 3; ++j) put(picture, x + k, y + 3 + j, kInkColor);
  image::draw_text(picture, x + length + 8, y, 1, kInkColor, image::text_of_value(metres) + " m");
}

/// A floor's plan with what is said about it.
Image8 draw_floor(const scene::Scene& scene, const LuxSettings& s, const LuxReport& report,
                  const PlanView& view, const image::ValueScale& scale) {
  const PlanValues values = values_of(view);
  Image8 plan = image::draw_values(values.value, view.width, scale, kEmpty, values.room);
  draw_walls(scene, view, view.lit.floor.y + s.plane.plane_m, plan);
  std::vector<std::array<int, 2>> taken;
  mark_extremes(view, plan, taken);
  image::label_isolines(plan, values.value, scale, taken);
  Image8 out{
      std::max(plan.width + 2 * kFrame, 420), plan.height + kHeading + kFrame + kScaleBand, 3, {}};
  out.data.assign(size_t(3) * size_t(out.width) * size_t(out.height), 255);
  for (int y = 0; y < plan.height; ++y)
    for (int x = 0; x < plan.width; ++x) {
      const uint8_t* p = plan.data.data() + 3 * (std::ptrdiff_t(y) * plan.width + x);
      put(out, kFrame + x, kHeading + y, {p[0], p[1], p[2]});
    }
  const RoomLight& all = view.lit.all;
  image::draw_text(out, kFrame, 10, 1, kInkColor,
                   fmt::format("floor at y = {} m, plane {} m above it, {} points",
                               image::text_of_value(
                                   std::round((view.lit.floor.y + report.origin.y) * 1000) / 1000),
                               image::text_of_value(s.plane.plane_m), all.points));
  image::draw_text(
      out, kFrame, 26, 1, kInkColor,
      fmt::format("mean {:.4g} {}, minimum {:.4g}, maximum {:.4g}, u0 = {:.2f}", all.mean,
                  report.unit.symbol, all.minimum, all.maximum, all.uniformity()));
  draw_scale_bar(view, out, kFrame, kHeading + plan.height + 10);
  return out;
}

}  // namespace

image::Image8 lux_plan(const scene::Scene& scene, const LuxSettings& s, const LuxReport& report) {
  std::vector<float> all;
  for (const LitFloor& lit : report.floors)
    all.insert(all.end(), lit.illuminance.begin(), lit.illuminance.end());
  const image::ValueScale scale = image::scale_for(all, report.unit.symbol);
  std::vector<Image8> plans;
  int width = 0, height = 0;
  for (const LitFloor& lit : report.floors) {
    plans.push_back(draw_floor(scene, s, report, view_of(lit), scale));
    width = std::max(width, plans.back().width), height += plans.back().height;
  }
  Image8 sheet{width, height, 3, {}};
  sheet.data.assign(size_t(3) * size_t(width) * size_t(height), kPaperColor[0]);
  int top = 0;
  for (const Image8& plan : plans) {
    for (int y = 0; y < plan.height; ++y)
      std::copy_n(plan.data.begin() + 3 * (std::ptrdiff_t(y) * plan.width), 3 * plan.width,
                  sheet.data.begin() + 3 * (std::ptrdiff_t(top + y) * width));
    top += plan.height;
  }
  return image::with_legend(sheet, scale);
}

}  // namespace luxel::pipeline
