// The hemicube: half a cube over a point, whose pixels share its hemisphere. [Cohen85]
#pragma once

#include <vector>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"
#include "luxel/base/vec.h"

namespace luxel::viewfactor {

/// Pixels of a cube of side 2 about the origin, cut by the plane z = 0: the top (z = 1) with n x n
/// pixels, then the sides +x, -x, +y, -y with n columns and n/2 rows each, rows from the top down.
/// 3 n^2 pixels in all.
struct Hemicube {
  int resolution = 0;                ///< n, even
  std::vector<Vec3> direction;       ///< unit, to the pixel's centre; the normal is +z
  std::vector<double> delta_factor;  ///< F(point -> pixel), exact; they sum to 1
};

/// `resolution` is even and at least 2. The stage "hemicube": 4096 takes seconds. Errors:
/// cancelled.
Result<Hemicube> make_hemicube(int resolution, Progress& progress);

}  // namespace luxel::viewfactor
