#include "luxel/display/triangle_raster.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "luxel/base/parallel.h"
#include "luxel/base/vec_double.h"

namespace luxel::display {
namespace {

/// Rows are looked at so much beyond what corners say [pixels]: more than rounding moves them.
constexpr double kRowMargin = 0.01;

/// A camera in double precision. Through the pixel's place (x, y) goes the ray from eye along
/// forward + aside, or seen in parallel from eye + aside along forward, where
/// aside = x right_px - y up_px - corner.
struct Eye {
  DVec3 eye, forward, up, right_px, up_px, corner;
  bool is_parallel = false;
  int width = 0, height = 0;
};

Eye eye_of(const trace::CameraRays& camera) {
  const DVec3 right = to_double(camera.right), up = to_double(camera.up);
  return {to_double(camera.eye),
          to_double(camera.forward),
          up,
          right * (2 / double(camera.width)),
          up * (2 / double(camera.height)),
          right - up,
          camera.orthographic,
          int(camera.width),
          int(camera.height)};
}

/// constant + dot(slope, aside).
PictureLinear over_picture(const Eye& eye, double constant, DVec3 slope) {
  return {dot(slope, eye.right_px), -dot(slope, eye.up_px), constant - dot(slope, eye.corner)};
}

PictureLinear scaled(const PictureLinear& l, double s) {
  return {l.across * s, l.down * s, l.start * s};
}

/// The weight of the corner opposite to the edge from a to b: six times the volume over edge and
/// ray. Turned around, an edge has the same with the other sign, to the last bit, so that no pixel
/// falls between two triangles.
PictureLinear weight_of(const Eye& eye, DVec3 a, DVec3 b) {
  if (eye.is_parallel)
    return over_picture(eye, dot(eye.forward, cross(a, b)), cross(eye.forward, b - a));
  const DVec3 across = cross(a, b);
  return over_picture(eye, dot(across, eye.forward), across);
}

/// The rows that corners reach, of the picture's rows; all of them where a corner is behind.
void set_rows(const Eye& eye, const std::array<DVec3, 3>& corner, PictureTriangle& t) {
  double least = INFINITY, most = -INFINITY;
  const double up2 = dot(eye.up, eye.up);
  t.first_row = 0, t.end_row = eye.height;
  for (const DVec3& c : corner) {
    const double depth = eye.is_parallel ? 1 : dot(c, eye.forward);
    if (!(depth > 1e-6 * length(c))) return;
    const double row = 0.5 * eye.height * (1 - dot(c, eye.up) / (up2 * depth));
    least = std::min(least, row), most = std::max(most, row);
  }
  const auto row_of = [&](double y) {
    return int(std::clamp(std::ceil(y), 0.0, double(eye.height)));
  };
  t.first_row = row_of(least - 0.5 - kRowMargin), t.end_row = row_of(most + 0.5 + kRowMargin);
}

/// Nothing: it turns its back, or is seen edge-on.
std::optional<PictureTriangle> picture_triangle(const Eye& eye, std::array<DVec3, 3> corner,
                                                bool is_two_sided) {
  for (DVec3& c : corner) c = c - eye.eye;
  const DVec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  // Below 0 for a front: of the direction in parallel, else of the way to the plane.
  const double height = dot(normal, corner[0]);
  const double facing = eye.is_parallel ? dot(normal, eye.forward) : height;
  if (!(facing < 0) && !(is_two_sided && facing > 0)) return std::nullopt;
  PictureTriangle t;
  const double sign = facing < 0 ? -1 : 1;
  for (size_t k = 0; k < 3; ++k)
    t.weight[k] = scaled(weight_of(eye, corner[(k + 1) % 3], corner[(k + 2) % 3]), sign);
  // The plane is met after the depth height / dot(normal, forward + aside), or in parallel after
  // (height - dot(normal, aside)) / facing.
  t.nearness = eye.is_parallel
                   ? over_picture(eye, -height / facing, normal * (1 / facing))
                   : over_picture(eye, dot(normal, eye.forward) / height, normal * (1 / height));
  set_rows(eye, corner, t);
  return t;
}

/// The pixels of a row whose middles are where none of some numbers is negative.
struct Span {
  double first = 0, last = 0;  ///< places of middles

  void cut(const PictureLinear& l, double y) {
    const double here = l.down * y + l.start;
    if (l.across > 0)
      first = std::max(first, -here / l.across);
    else if (l.across < 0)
      last = std::min(last, -here / l.across);
    else if (here < 0)
      last = -1;
  }
};

void fill_row(const PictureTriangle& t, uint32_t place, int y, bool is_parallel, RasterRows& rows) {
  const double middle = y + 0.5;
  Span span{0, double(rows.width)};
  for (const PictureLinear& weight : t.weight) span.cut(weight, middle);
  if (is_parallel) span.cut(scaled(t.nearness, -1), middle);
  if (!(span.first <= span.last)) return;
  const int first = int(std::ceil(span.first - 0.5)),
            last = std::min(int(std::floor(span.last - 0.5)), rows.width - 1);
  const auto start = float(t.nearness.at(first + 0.5, middle));
  const auto step = float(t.nearness.across);
  const size_t row = size_t(y - rows.first) * size_t(rows.width);
  float* nearness = rows.nearness.data() + row;
  uint32_t* seen = rows.seen.data() + row;
  for (int x = first; x <= last; ++x) {
    const float here = start + step * float(x - first);
    const bool is_nearer = here > nearness[x];
    nearness[x] = is_nearer ? here : nearness[x];
    seen[x] = is_nearer ? place : seen[x];
  }
}

}  // namespace

Barycentric place_at(const PictureTriangle& t, double x, double y) {
  const double a = t.weight[0].at(x, y), b = t.weight[1].at(x, y), c = t.weight[2].at(x, y);
  const double scale = 1 / (a + b + c);
  return {float(b * scale), float(c * scale)};
}

std::vector<PictureTriangle> picture_triangles(const Triangles& triangles,
                                               const trace::CameraRays& camera) {
  const Eye eye = eye_of(camera);
  std::vector<PictureTriangle> all(triangles.corners.size());
  parallel_for(all.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      std::array<DVec3, 3> corner;
      for (size_t i = 0; i < 3; ++i)
        corner[i] = to_double(triangles.vertices[triangles.corners[k][i]]);
      if (const auto t = picture_triangle(eye, corner, triangles.two_sided[k] != 0)) all[k] = *t;
      all[k].triangle = uint32_t(k);
    }
  });
  std::erase_if(all, [](const PictureTriangle& t) { return t.first_row >= t.end_row; });
  return all;
}

void fill(std::span<const PictureTriangle> list, std::span<const uint32_t> some, bool is_parallel,
          RasterRows& rows) {
  const size_t pixels = size_t(rows.end - rows.first) * size_t(rows.width);
  rows.nearness.assign(pixels, is_parallel ? -INFINITY : 0);
  rows.seen.assign(pixels, scene::kNone);
  for (const uint32_t place : some) {
    const PictureTriangle& t = list[place];
    for (int y = std::max(t.first_row, rows.first); y < std::min(t.end_row, rows.end); ++y)
      fill_row(t, place, y, is_parallel, rows);
  }
}

}  // namespace luxel::display
