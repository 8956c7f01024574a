#include "luxel/atlas/cover.h"

#include <algorithm>

namespace luxel::atlas {
namespace {

/// Twice the area of (a, b, p): positive when p lies on the inner side of edge a-b.
double side_of(DVec2 a, DVec2 b, DVec2 p) { return cross(b - a, p - a); }

double low_y(const UvTriangle& t) {
  return std::min({t.corner[0].y, t.corner[1].y, t.corner[2].y});
}
double high_y(const UvTriangle& t) {
  return std::max({t.corner[0].y, t.corner[1].y, t.corner[2].y});
}
double low_x(const UvTriangle& t) {
  return std::min({t.corner[0].x, t.corner[1].x, t.corner[2].x});
}
double high_x(const UvTriangle& t) {
  return std::max({t.corner[0].x, t.corner[1].x, t.corner[2].x});
}

/// Separating axes of a triangle and the open squares of a row: x, y and the three edge normals.
/// Exact.
class TouchedInRow {
 public:
  TouchedInRow(const UvTriangle& t, int row)
      : t_(t),
        row_(row),
        low_x_(low_x(t)),
        high_x_(high_x(t)),
        meets_row_(low_y(t) < row + 1 && high_y(t) > row) {}

  bool operator()(int i) const {
    if (!(meets_row_ && low_x_ < i + 1 && high_x_ > i)) return false;
    for (int k = 0; k < 3; ++k) {
      const DVec2 a = t_.corner[k], b = t_.corner[(k + 1) % 3];
      const DVec2 innermost{b.y > a.y ? double(i) : i + 1.0, b.x > a.x ? row_ + 1.0 : double(row_)};
      if (side_of(a, b, innermost) <= 0) return false;
    }
    return true;
  }

 private:
  const UvTriangle& t_;
  int row_;
  double low_x_, high_x_;
  bool meets_row_;
};

/// The x-range of a triangle within y0 <= y <= y1, up to rounding; begin > end when empty.
std::pair<double, double> x_range(const UvTriangle& t, double y0, double y1) {
  double low = INFINITY, high = -INFINITY;
  const auto add = [&](double x) { low = std::min(low, x), high = std::max(high, x); };
  for (int k = 0; k < 3; ++k) {
    const DVec2 a = t.corner[k], b = t.corner[(k + 1) % 3];
    if (a.y >= y0 && a.y <= y1) add(a.x);
    for (const double y : {y0, y1})
      if ((a.y < y) != (b.y < y)) add(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
  }
  return {low, high};
}

bool holds_centre(const UvTriangle& t, int i, int j, CentreRule rule) {
  const DVec2 centre{i + 0.5, j + 0.5};
  for (int k = 0; k < 3; ++k) {
    const double s = side_of(t.corner[k], t.corner[(k + 1) % 3], centre);
    if (s < 0 || (s == 0 && rule == CentreRule::strictly_inside)) return false;
  }
  return true;
}

/// Rounding may have put a range's ends one texel too far out: the exact test moves them back.
template <class Test>
Span trimmed(Span span, Test&& test) {
  while (span.begin < span.end && !test(span.begin)) ++span.begin;
  while (span.begin < span.end && !test(span.end - 1)) --span.end;
  return span;
}

constexpr double kSlack = 1e-7;  // texels; far above the rounding of x_range

}  // namespace

UvTriangle uv_triangle(const std::array<DVec2, 3>& corners) {
  UvTriangle t{corners, cross(corners[1] - corners[0], corners[2] - corners[0])};
  if (t.area2 < 0) {
    std::swap(t.corner[1], t.corner[2]);
    t.area2 = -t.area2;
  }
  return t;
}

Span touched_rows(const UvTriangle& t) {
  const int begin = int(std::floor(low_y(t)));
  if (t.area2 == 0) return {begin, int(std::floor(high_y(t))) + 1};
  return {begin, int(std::ceil(high_y(t)))};
}

Span touched_texels(const UvTriangle& t, int row) {
  const auto [low, high] = x_range(t, row, row + 1.0);
  if (!(low <= high)) return {};
  if (t.area2 == 0) return {int(std::floor(low)), int(std::floor(high)) + 1};
  const Span loose{int(std::floor(low - kSlack)), int(std::floor(high + kSlack)) + 1};
  return trimmed(loose, TouchedInRow(t, row));
}

Span centre_texels(const UvTriangle& t, int row, CentreRule rule) {
  if (t.area2 == 0) return {};
  const auto [low, high] = x_range(t, row + 0.5, row + 0.5);
  if (!(low <= high)) return {};
  const Span loose{int(std::floor(low - 0.5 - kSlack)), int(std::floor(high + 0.5 + kSlack)) + 1};
  return trimmed(loose, [&](int i) { return holds_centre(t, i, row, rule); });
}

bool holds_texel(const UvTriangle& t, int i, int j) {
  for (int k = 0; k < 3; ++k) {
    const DVec2 a = t.corner[k], b = t.corner[(k + 1) % 3];
    const DVec2 outermost{b.y > a.y ? i + 1.0 : double(i), b.x > a.x ? double(j) : j + 1.0};
    if (side_of(a, b, outermost) < 0) return false;
  }
  return true;
}

ClippedCorners clipped_corners(const UvTriangle& t, int column, int row) {
  // Relative to the texel's corner, where the digits are. [Sutherland74]
  ClippedCorners out, next;
  out.count = 3;
  for (size_t k = 0; k < 3; ++k) out.corner[k] = t.corner[k] - DVec2{double(column), double(row)};
  for (int side = 0; side < 4; ++side) {
    const auto inside = [&](DVec2 p) {
      return side == 0 ? p.x : side == 1 ? 1 - p.x : side == 2 ? p.y : 1 - p.y;
    };
    next.count = 0;
    for (size_t k = 0; k < out.count; ++k) {
      const DVec2 a = out.corner[k], b = out.corner[(k + 1) % out.count];
      const double da = inside(a), db = inside(b);
      if (da >= 0) next.corner[next.count++] = a;
      if ((da > 0 && db < 0) || (da < 0 && db > 0))
        next.corner[next.count++] = a + (b - a) * (da / (da - db));
    }
    out = next;
  }
  return out;
}

Clip clip_to_texel(const UvTriangle& t, int column, int row) {
  const auto [polygon, count] = clipped_corners(t, column, row);
  Clip clip;
  DVec2 sum;
  for (size_t k = 2; k < count; ++k) {
    const double area2 = cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
    clip.area += 0.5 * area2;
    sum = sum + (polygon[0] + polygon[k - 1] + polygon[k]) * (area2 / 6);
  }
  if (clip.area <= 0) return {};
  clip.centroid = sum * (1 / clip.area) + DVec2{double(column), double(row)};
  return clip;
}

}  // namespace luxel::atlas
