// A work plane: points of a grid above each floor of a scene.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::pipeline {

struct WorkPlaneParams {
  double plane_m = 0.85;            ///< height of the points above their floor
  std::optional<double> spacing_m;  ///< at most, between points; unset: that of EN 12464-1
  double boundary_m = 0;            ///< points nearer to a wall are left out
  std::vector<double> floors;       ///< heights Y of the floors that are meant [m]; empty: found
};

struct PlanePoint {
  Vec3 position{};
  int column = 0, row = 0;  ///< of the floor's grid
  uint32_t room = 0;        ///< index into Floor::rooms
};

/// One floor and its grid: cells of equal size over its bounds, a point in the middle of each.
struct Floor {
  double y = 0;                           ///< its height [m], the middle of what it spans
  double x0 = 0, z0 = 0, x1 = 0, z1 = 0;  ///< its bounds [m]
  int columns = 0, rows = 0;              ///< along x, along z
  std::vector<PlanePoint> points;         ///< row by row
  uint32_t room_count = 0;
  size_t in_solids = 0, in_boundary = 0;  ///< points that were left out

  double cell_x() const { return (x1 - x0) / columns; }
  double cell_z() const { return (z1 - z0) / rows; }
};

/// Floors from below to above, and the points above them.
///
/// A floor is found where many vertical lines meet a surface from above that has at least plane_m
/// of room over it and something over that (in a scene without any ceiling: nothing is needed over
/// it). Surfaces less than 1.8 m above a floor are furniture, and so is what has less than a tenth
/// of the largest floor's area. A point stands over each cell's middle where the floor is under it,
/// whatever stands between; points inside solids are left out (transport::is_enclosed).
///
/// Points beside each other are in one room where nothing parts them just under the ceiling, and
/// where their ceilings are alike: a door under a lintel of 0.3 m parts rooms, furniture does not.
///
/// Errors: no floor, none at a height asked for, too many points, cancelled.
Result<std::vector<Floor>> find_work_planes(const scene::Scene& scene,
                                            const trace::RayTracer& tracer,
                                            const WorkPlaneParams& params, Progress& progress);

/// The largest spacing [m] that EN 12464-1 allows for a field of these sides: 0.2 * 5^(log10 d), d
/// the longer side, or the shorter one where the longer is twice as long or more; 10 at most.
double standard_spacing_m(double side_x_m, double side_z_m);

}  // namespace luxel::pipeline
