#include "luxel/view/edit/placement.h"

#include <cmath>

namespace luxel::view {
namespace {

constexpr float kRadPerDegree = kPi / 180;

/// The map without its translation.
Mat34 linear_part(Mat34 m) {
  for (auto& row : m.row) row[3] = 0;
  return m;
}

/// The axes are orthonormal.
Mat34 transposed(const Mat34& m) {
  return from_columns({m.row[0][0], m.row[0][1], m.row[0][2]},
                      {m.row[1][0], m.row[1][1], m.row[1][2]},
                      {m.row[2][0], m.row[2][1], m.row[2][2]}, {});
}

/// A linear map of the world about a place, which stays.
Mat34 about(Vec3 place, const Mat34& linear) {
  Mat34 out = linear;
  const Vec3 by = place - transform_vector(linear, place);
  out.row[0][3] = by.x, out.row[1][3] = by.y, out.row[2][3] = by.z;
  return out;
}

Mat34 rotation(Vec3 angles_deg) {
  const Vec3 o{};
  return turned_about(o, {0, 1, 0}, angles_deg.y * kRadPerDegree) *
         turned_about(o, {1, 0, 0}, angles_deg.x * kRadPerDegree) *
         turned_about(o, {0, 0, 1}, angles_deg.z * kRadPerDegree);
}

/// Ry Rx Rz has the second row (cos x sin z, cos x cos z, -sin x) and the third column
/// (sin y cos x, -sin x, cos y cos x).
Vec3 angles_of(const Mat34& turn) {
  const float sine = std::clamp(0 - turn.row[1][2], -1.0f, 1.0f);
  constexpr float kUpright = 0.9999999f;
  if (std::abs(sine) > kUpright)  // turned by y or by z is the same
    return Vec3{std::asin(sine), std::atan2(0 - turn.row[2][0], turn.row[0][0]), 0} / kRadPerDegree;
  return Vec3{std::asin(sine), std::atan2(turn.row[0][2], turn.row[2][2]),
              std::atan2(turn.row[1][0], turn.row[1][1])} /
         kRadPerDegree;
}

}  // namespace

Mat34 turn_of(const Mat34& m) {
  const float side = determinant(m) < 0 ? -1.0f : 1.0f;
  const Vec3 x = normalize(column(m, 0)) * side;
  const Vec3 y = normalize(column(m, 1) - x * dot(x, column(m, 1)));
  return from_columns(x, y, cross(x, y), {});
}

Mat34 turned_about(Vec3 place, Vec3 axis, float angle_rad) {
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  const auto image = [&](Vec3 v) {
    return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
  };
  return about(place, from_columns(image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1}), {}));
}

Mat34 scaled_about(Vec3 place, const Mat34& axes, Vec3 factors) {
  if (factors == Vec3{1, 1, 1}) return {};
  const Mat34 turn = linear_part(axes);
  return about(place, turn * scaling(factors) * transposed(turn));
}

Placement placement_of(const Mat34& m, Vec3 middle) {
  const float side = determinant(m) < 0 ? -1.0f : 1.0f;
  return {transform_point(m, middle),
          angles_of(turn_of(m)),
          {side * length(column(m, 0)), length(column(m, 1)), length(column(m, 2))}};
}

Mat34 placed(const Mat34& m, Vec3 middle, const Placement& now) {
  const Placement was = placement_of(m, middle);
  Mat34 out = m;
  if (now.scale != was.scale) {
    const Vec3 by{now.scale.x / was.scale.x, now.scale.y / was.scale.y, now.scale.z / was.scale.z};
    out = out * scaled_about(middle, {}, by);
  }
  if (now.angles_deg != was.angles_deg)
    out = about(was.place, rotation(now.angles_deg) * transposed(turn_of(m))) * out;
  if (now.place != was.place) out = translation(now.place - was.place) * out;
  return out;
}

}  // namespace luxel::view
