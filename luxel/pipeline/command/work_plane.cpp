#include "luxel/pipeline/command/work_plane.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/base/disjoint_sets.h"
#include "luxel/base/parallel.h"
#include "luxel/scene/off_surface.h"
#include "luxel/transport/back_faces.h"

namespace luxel::pipeline {
namespace {

/// Vertical lines along the longer side of the scene, by which floors are found.
constexpr int kLines = 240;
/// Surfaces along a vertical line that are looked at.
constexpr int kMostSurfaces = 64;
/// Steeper surfaces are no floors: 45 degrees.
constexpr float kUpwards = 0.7071f;
/// Heights that differ by less belong to one floor [m]: rugs, thresholds, ramps.
constexpr double kOneFloor_m = 0.1;
/// A storey is at least so high [m]; what is lower stands on a floor.
constexpr double kStorey_m = 1.8;
/// A floor has at least this part of the largest one's area.
constexpr double kLeastArea = 0.1;
/// Rooms are parted so far below the ceiling [m].
constexpr float kUnderCeiling_m = 0.15f;
/// Ceilings of neighbours in a room differ by this at most [m], or by a slope.
constexpr float kLintel_m = 0.3f, kSlope = 0.5f;
constexpr size_t kMostPlanePoints = 4'000'000;
constexpr int kEnclosureRays = 64, kBoundaryRays = 32;

/// A surface that a vertical line meets from above.
struct Step {
  float x, y, z;
  bool is_free;  ///< plane_m of room above it, and something above that
};

bool faces_up(const scene::Scene& scene, const trace::Hit& hit) {
  const Vec3 n = scene::front_normal(scene, hit.instance, hit.triangle);
  if (std::abs(n.y) < kUpwards) return false;
  return !hit.back_face || scene::reflects_from_behind(scene::material_at(scene, hit.point()));
}

/// Rays go on so many times scene::rounding_m() behind a surface that they have met.
constexpr float kOnBehind = 4;

/// All surfaces down from a point, as far as `depth_m`: calls meet(hit, height).
template <class Meet>
void go_down(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from, float depth_m,
             const Meet& meet) {
  float t = 0;
  for (int k = 0; k < kMostSurfaces; ++k) {
    const trace::Hit hit = tracer.closest_hit({from, t, {0, -1, 0}, depth_m});
    if (!hit.found()) return;
    meet(hit, from.y - hit.t);
    const scene::Facet facet = scene::facet_of(scene, hit.instance, hit.triangle);
    t = hit.t + kOnBehind * scene::rounding_m(from + Vec3{0, -hit.t, 0}, facet.size_m);
  }
}

/// Margin between the ends of a line and its first and last surface [m].
float slack_of(const Box3& box) {
  return kOnBehind * scene::rounding_m(max(-box.lower, box.upper), 0);
}

struct Survey {
  std::vector<Step> steps;
  double cell_m2 = 0, line_m = 0;
};

/// Surfaces that vertical lines over the scene's bounds meet.
Survey survey(const scene::Scene& scene, const trace::RayTracer& tracer, double plane_m,
              bool needs_ceiling) {
  const Box3 box = scene::world_bounds(scene);
  const Vec3 size = box.upper - box.lower;
  const float line_m = std::max(std::max(size.x, size.z) / kLines, 1e-6f);
  const float slack_m = slack_of(box);
  const int columns = std::max(1, int(std::ceil(size.x / line_m)));
  const int rows = std::max(1, int(std::ceil(size.z / line_m)));
  std::vector<std::vector<Step>> by_row{size_t(rows)};
  parallel_for(size_t(rows), 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (int column = 0; column < columns; ++column) {
        // Off the middle, so that lines miss the edges of models made on a raster.
        const Vec3 from{box.lower.x + (float(column) + 0.487f) * line_m, box.upper.y + slack_m,
                        box.lower.z + (float(row) + 0.513f) * line_m};
        float above = INFINITY, highest = -INFINITY;
        go_down(scene, tracer, from, size.y + 3 * slack_m, [&](const trace::Hit& hit, float y) {
          const bool room = above - y >= float(plane_m);
          const bool covered = highest - y >= float(plane_m);
          if (faces_up(scene, hit))
            by_row[row].push_back({from.x, y, from.z, room && (covered || !needs_ceiling)});
          above = y, highest = std::max(highest, y);
        });
      }
  });
  Survey out;
  out.cell_m2 = double(line_m) * double(line_m), out.line_m = double(line_m);
  for (const std::vector<Step>& row : by_row)
    out.steps.insert(out.steps.end(), row.begin(), row.end());
  return out;
}

/// Steps of nearly one height.
struct Level {
  double low = 0, high = 0;
  size_t free = 0;
  std::vector<Step> steps;
};

std::vector<Level> levels_of(std::vector<Step> steps) {
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.y < b.y; });
  std::vector<Level> out;
  for (const Step& step : steps) {
    if (out.empty() || double(step.y) - out.back().high > kOneFloor_m)
      out.push_back({double(step.y), double(step.y), 0, {}});
    Level& level = out.back();
    level.high = double(step.y), level.free += step.is_free, level.steps.push_back(step);
  }
  return out;
}

/// The levels that are floors.
std::vector<Level> floors_among(std::vector<Level> levels) {
  size_t most = 0;
  for (const Level& level : levels) most = std::max(most, level.free);
  std::vector<Level> out;
  for (Level& level : levels) {
    if (level.free == 0 || double(level.free) < kLeastArea * double(most)) continue;
    if (!out.empty() && level.low - out.back().high < kStorey_m) continue;
    out.push_back(std::move(level));
  }
  return out;
}

/// The levels nearest to heights asked for.
Result<std::vector<Level>> floors_at(std::span<const double> heights,
                                     const std::vector<Level>& levels, double origin_y) {
  std::vector<Level> out;
  for (const double stated : heights) {
    const double y = stated - origin_y;
    const auto found = std::find_if(levels.begin(), levels.end(), [y](const Level& level) {
      return y >= level.low - kOneFloor_m && y <= level.high + kOneFloor_m;
    });
    if (found == levels.end())
      return fail(ErrorCode::bad_setting,
                  "--floor {}: no surface faces up at this height; leave it out to see which "
                  "floors luxel finds",
                  stated);
    out.push_back(*found);
  }
  return out;
}

/// The bounds of a level's free steps, or, where there are none, of all, moved to the edges of the
/// triangles that carry them: lines find these to half a line.
Floor bounds_of(const scene::Scene& scene, const Level& level, double line_m) {
  Floor out;
  out.y = 0.5 * (level.low + level.high);
  out.x0 = out.z0 = INFINITY, out.x1 = out.z1 = -INFINITY;
  for (const Step& step : level.steps) {
    if (!step.is_free && level.free > 0) continue;
    out.x0 = std::min(out.x0, double(step.x)), out.x1 = std::max(out.x1, double(step.x));
    out.z0 = std::min(out.z0, double(step.z)), out.z1 = std::max(out.z1, double(step.z));
  }
  std::array<double*, 4> sides{&out.x0, &out.x1, &out.z0, &out.z1};
  std::array<double, 4> moved{out.x0 - 0.5 * line_m, out.x1 + 0.5 * line_m, out.z0 - 0.5 * line_m,
                              out.z1 + 0.5 * line_m};
  std::array<double, 4> nearest{line_m, line_m, line_m, line_m};
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      const scene::Triangle3 t = scene::world_triangle(scene, i, k);
      for (const Vec3& p : {t.a, t.b, t.c}) {
        if (double(p.y) < level.low - kOneFloor_m || double(p.y) > level.high + kOneFloor_m)
          continue;
        for (size_t side = 0; side < 4; ++side) {
          const double at = double(side < 2 ? p.x : p.z), d = std::abs(at - *sides[side]);
          if (d < nearest[side]) nearest[side] = d, moved[side] = at;
        }
      }
    }
  }
  for (size_t side = 0; side < 4; ++side) *sides[side] = moved[side];
  return out;
}

/// The height just under the ceiling over a point, where rooms are parted; its own without ceiling.
float parting_height(const trace::RayTracer& tracer, Vec3 p) {
  const trace::Hit above = tracer.closest_hit({p, 0, {0, 1, 0}, INFINITY});
  return above.found() ? p.y + std::max(0.0f, above.t - kUnderCeiling_m) : p.y;
}

bool is_near_a_wall(const trace::RayTracer& tracer, Vec3 p, double boundary_m) {
  const Vec3 from{p.x, parting_height(tracer, p), p.z};
  // A point at just this distance stays, whatever floats make of it.
  const float reach_m = float(boundary_m * (1 - 1e-4));
  for (int k = 0; k < kBoundaryRays; ++k) {
    const float phi = 2 * kPi * float(k) / kBoundaryRays;
    const trace::Ray ray{from, 0, {std::cos(phi), 0, std::sin(phi)}, reach_m};
    if (tracer.closest_hit(ray).found()) return true;
  }
  return false;
}

enum class Kept : uint8_t { no_floor, in_solid, in_boundary, yes };

/// The points of one floor's grid.
void add_points(const scene::Scene& scene, const trace::RayTracer& tracer, const Level& level,
                const WorkPlaneParams& params, Floor& floor, Progress& progress) {
  const float slack_m = slack_of(scene::world_bounds(scene));
  const size_t cells = size_t(floor.columns) * size_t(floor.rows);
  std::vector<PlanePoint> points(cells);
  std::vector<Kept> kept(cells, Kept::no_floor);
  parallel_for(cells, 64, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !progress.cancelled(); ++i) {
      PlanePoint& point = points[i];
      point.column = int(i % size_t(floor.columns)), point.row = int(i / size_t(floor.columns));
      const Vec3 from{float(floor.x0 + (point.column + 0.5) * floor.cell_x()),
                      float(level.high + params.plane_m),
                      float(floor.z0 + (point.row + 0.5) * floor.cell_z())};
      const float depth_m = float(level.high - level.low + params.plane_m) + 4 * slack_m;
      float ground = -INFINITY, bottom = -INFINITY;
      go_down(scene, tracer, from, depth_m, [&](const trace::Hit& hit, float y) {
        const bool here = double(y) >= level.low - 1e-3 && double(y) <= level.high + 1e-3;
        float& highest = faces_up(scene, hit) ? ground : bottom;
        if (here) highest = std::max(highest, y);
      });
      // The bottom of a solid that stands on the floor may be met instead, within it and on its
      // sides.
      if (ground == -INFINITY) ground = bottom;
      const bool no_floor = ground == -INFINITY;
      point.position = {from.x, (no_floor ? float(floor.y) : ground) + float(params.plane_m),
                        from.z};
      if (transport::is_enclosed(scene, tracer, point.position, {0, 1, 0}, kEnclosureRays))
        kept[i] = Kept::in_solid;
      else if (!no_floor)
        kept[i] = params.boundary_m > 0 && is_near_a_wall(tracer, point.position, params.boundary_m)
                      ? Kept::in_boundary
                      : Kept::yes;
    }
  });
  for (size_t i = 0; i < cells; ++i) {
    floor.in_solids += kept[i] == Kept::in_solid, floor.in_boundary += kept[i] == Kept::in_boundary;
    if (kept[i] == Kept::yes) floor.points.push_back(points[i]);
  }
}

/// Numbers the rooms of a floor in the order of their first points.
void find_rooms(const trace::RayTracer& tracer, Floor& floor) {
  std::vector<uint32_t> at(size_t(floor.columns) * size_t(floor.rows), scene::kNone);
  std::vector<float> height(floor.points.size());
  for (uint32_t i = 0; i < floor.points.size(); ++i) {
    const PlanePoint& p = floor.points[i];
    at[size_t(p.row) * size_t(floor.columns) + size_t(p.column)] = i;
    height[i] = parting_height(tracer, p.position);
  }
  std::vector<uint32_t> parent(floor.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto join = [&](uint32_t i, int column, int row) {
    if (column >= floor.columns || row >= floor.rows) return;
    const uint32_t j = at[size_t(row) * size_t(floor.columns) + size_t(column)];
    if (j == scene::kNone) return;
    Vec3 a = floor.points[i].position, b = floor.points[j].position;
    a.y = height[i], b.y = height[j];
    // A point in a doorway has the lintel over it, far lower than the ceilings beside it.
    const float level = std::max(kLintel_m, kSlope * std::hypot(b.x - a.x, b.z - a.z));
    if (std::abs(a.y - b.y) > level) return;
    if (tracer.closest_hit({a, 0, b - a, 1}).found()) return;
    parent[root_of(parent, j)] = root_of(parent, i);
  };
  for (uint32_t i = 0; i < floor.points.size(); ++i) {
    join(i, floor.points[i].column + 1, floor.points[i].row);
    join(i, floor.points[i].column, floor.points[i].row + 1);
  }
  std::vector<uint32_t> number(floor.points.size(), scene::kNone);
  for (uint32_t i = 0; i < floor.points.size(); ++i) {
    uint32_t& room = number[root_of(parent, i)];
    if (room == scene::kNone) room = floor.room_count++;
    floor.points[i].room = room;
  }
}

/// Divides a floor's bounds into cells.
Status divide(const WorkPlaneParams& params, Floor& floor) {
  const double x = floor.x1 - floor.x0, z = floor.z1 - floor.z0;
  const double spacing = params.spacing_m.value_or(standard_spacing_m(x, z));
  // A side that is a multiple but for rounding has no cell more.
  const double columns = std::max(1.0, std::ceil(x / spacing - 1e-3));
  const double rows = std::max(1.0, std::ceil(z / spacing - 1e-3));
  if (columns * rows > double(kMostPlanePoints))
    return fail(
        ErrorCode::bad_setting,
        "--spacing {}: a floor of {:.3g} m by {:.3g} m would have more than {} points; give "
        "a larger one",
        spacing, x, z, kMostPlanePoints);
  floor.columns = int(columns), floor.rows = int(rows);
  return {};
}

}  // namespace

double standard_spacing_m(double side_x_m, double side_z_m) {
  const double longer = std::max(side_x_m, side_z_m), shorter = std::min(side_x_m, side_z_m);
  const double d = std::max(longer < 2 * shorter ? longer : shorter, 1e-6);
  return std::min(0.2 * std::pow(5.0, std::log10(d)), 10.0);
}

Result<std::vector<Floor>> find_work_planes(const scene::Scene& scene,
                                            const trace::RayTracer& tracer,
                                            const WorkPlaneParams& params, Progress& progress) {
  progress.begin("work plane", 0);
  Survey found = survey(scene, tracer, params.plane_m, true);
  const auto is_free = [](const Step& step) { return step.is_free; };
  if (std::none_of(found.steps.begin(), found.steps.end(), is_free))
    found = survey(scene, tracer, params.plane_m, false);
  std::vector<Level> levels = levels_of(std::move(found.steps));
  if (!params.floors.empty()) {
    LUXEL_TRY(levels, floors_at(params.floors, levels, scene.origin.y));
  } else {
    levels = floors_among(std::move(levels));
  }
  if (levels.empty())
    return fail(ErrorCode::bad_input,
                "--plane {}: no surface that faces up has that much room above it; give a lower "
                "plane, in metres above the floor, or name the floor with --floor",
                params.plane_m);
  std::vector<Floor> floors;
  for (const Level& level : levels) {
    Floor floor = bounds_of(scene, level, found.line_m);
    LUXEL_TRY_STATUS(divide(params, floor));
    add_points(scene, tracer, level, params, floor, progress);
    LUXEL_TRY_STATUS(stopped(progress));
    find_rooms(tracer, floor);
    floors.push_back(std::move(floor));
  }
  return floors;
}

}  // namespace luxel::pipeline
