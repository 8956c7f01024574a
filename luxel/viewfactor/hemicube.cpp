#include "luxel/viewfactor/hemicube.h"

#include <array>
#include <numeric>

#include "luxel/base/check.h"
#include "luxel/viewfactor/point_form_factor.h"

namespace luxel::viewfactor {
namespace {

/// A face of the cube: the point at (s, t), both in [-1, 1], is centre + s right + t up.
struct Face {
  DVec3 centre, right, up;
};

void add_pixel(const Face& face, double s, double t, double size, Hemicube& cube) {
  const auto at = [&](double x, double y) { return face.centre + face.right * x + face.up * y; };
  // Clockwise from outside, which is counter-clockwise seen from the point.
  const double h = 0.5 * size;
  const std::array<DVec3, 4> corners{at(s - h, t - h), at(s + h, t - h), at(s + h, t + h),
                                     at(s - h, t + h)};
  cube.direction.push_back(to_float(normalize(at(s, t))));
  cube.delta_factor.push_back(point_to_polygon(DVec3{}, DVec3{0, 0, 1}, corners));
}

}  // namespace

Result<Hemicube> make_hemicube(int resolution, Progress& progress) {
  LUXEL_CHECK(resolution >= 2 && resolution % 2 == 0);
  const size_t n = size_t(resolution);
  progress.begin("hemicube", 3 * n * n);
  Hemicube cube{resolution, {}, {}};
  cube.direction.reserve(3 * n * n);
  cube.delta_factor.reserve(3 * n * n);
  // right x up points to the centre of the cube.
  const std::array<Face, 5> faces{{{{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
                                   {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
                                   {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                   {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                   {{0, -1, 0}, {-1, 0, 0}, {0, 0, 1}}}};
  const double size = 2.0 / resolution;
  for (size_t f = 0; f < faces.size(); ++f) {
    const int rows = f == 0 ? resolution : resolution / 2;
    for (int row = 0; row < rows; ++row) {
      LUXEL_TRY_STATUS(stopped(progress));
      for (int column = 0; column < resolution; ++column)
        add_pixel(faces[f], -1 + (column + 0.5) * size, 1 - (row + 0.5) * size, size, cube);
      progress.advance(n);
    }
  }
  // They sum to 1 but for rounding, which goes too.
  const double sum = std::accumulate(cube.delta_factor.begin(), cube.delta_factor.end(), 0.0);
  for (double& factor : cube.delta_factor) factor /= sum;
  return cube;
}

}  // namespace luxel::viewfactor
