// A raster of triangles: the one that each pixel of a camera sees is found without rays, by filling
// the rows of each triangle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/camera_rays.h"

namespace luxel::display {

/// Triangles that share vertices, counter-clockwise from the front. Backs are invisible but of
/// those that are two-sided.
struct Triangles {
  std::span<const Vec3> vertices;
  std::span<const std::array<uint32_t, 3>> corners;  ///< per triangle
  std::span<const uint8_t> two_sided;                ///< per triangle
};

/// A number that is linear over the picture.
struct PictureLinear {
  double across = 0, down = 0, start = 0;
  double at(double x, double y) const { return across * x + (down * y + start); }
};

/// A triangle as a picture has it. A pixel's middle is inside where no weight is negative; the
/// weights are those of the corners, times a number. Nothing is projected, so that triangles may
/// reach behind the eye. [Olano97]
struct PictureTriangle {
  std::array<PictureLinear, 3> weight;
  PictureLinear nearness;  ///< 1 / depth; seen in parallel, -depth, which must not be positive
  uint32_t triangle = 0;
  int first_row = 0, end_row = 0;
};

/// The weights of the second and the third corner where a pixel's middle sees the triangle.
Barycentric place_at(const PictureTriangle& triangle, double x, double y);

/// All triangles that turn a visible side to the camera, in order.
std::vector<PictureTriangle> picture_triangles(const Triangles& triangles,
                                               const trace::CameraRays& camera);

/// Pixels of some rows of a picture, and what fills them.
struct RasterRows {
  int first = 0, end = 0, width = 0;
  std::vector<float> nearness;
  std::vector<uint32_t> seen;  ///< per pixel its nearest triangle's place in the list; kNone: none
};
/// Fills rows by triangles of `list`: of those whose places are `some`, and of equally near ones by
/// the first.
void fill(std::span<const PictureTriangle> list, std::span<const uint32_t> some, bool is_parallel,
          RasterRows& rows);

}  // namespace luxel::display
