// Texels that a triangle touches, and which texel centres it holds.
//
// The layout puts all corners on a fixed-point grid of 23 bits (layout.h), so the products below
// are exact in double precision: the packer and the rasteriser see the same texels, always.
#pragma once

#include <array>
#include <vector>

#include "luxel/atlas/plane.h"

namespace luxel::atlas {

/// A triangle in texels whose corners turn so that its area is positive.
struct UvTriangle {
  std::array<DVec2, 3> corner;
  double area2 = 0;  ///< twice the area; 0: a segment or a point
};
UvTriangle uv_triangle(const std::array<DVec2, 3>& corners);

/// Texels [begin, end) of a row, or rows of a triangle.
struct Span {
  int begin = 0, end = 0;
  bool empty() const { return begin >= end; }
  friend bool operator==(Span, Span) = default;
};

/// Rows with touched texels.
Span touched_rows(const UvTriangle& t);
/// Texels of a row whose inside meets the triangle's inside. A triangle without area touches the
/// texels that hold its points.
Span touched_texels(const UvTriangle& t, int row);
/// Texels of a row whose centre lies in the triangle, its border included or not.
enum class CentreRule { inside_or_border, strictly_inside };
Span centre_texels(const UvTriangle& t, int row, CentreRule rule);
/// The whole texel lies in the triangle.
bool holds_texel(const UvTriangle& t, int column, int row);

/// The part of a triangle that lies in a texel; empty when they share no area.
struct Clip {
  double area = 0;
  DVec2 centroid;
};
Clip clip_to_texel(const UvTriangle& t, int column, int row);
/// Its corners, relative to the texel's upper left one.
struct ClippedCorners {
  std::array<DVec2, 9> corner;
  size_t count = 0;
};
ClippedCorners clipped_corners(const UvTriangle& t, int column, int row);

}  // namespace luxel::atlas
