#include "luxel/scene/light_profile.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/check.h"
#include "luxel/base/vec_double.h"
#include "luxel/scene/light_kinds.h"
#include "luxel/scene/scene.h"

namespace luxel::scene {
namespace {

struct GridCell {
  size_t first = 0;
  float share = 0;  ///< of the entry after `first`
};

/// Where `angle` lies between ascending angles that reach around it.
GridCell cell_of(const std::vector<float>& angles, float angle) {
  const auto above = std::upper_bound(angles.begin() + 1, angles.end() - 1, angle);
  const size_t first = size_t(above - angles.begin()) - 1;
  const float share = (angle - angles[first]) / (angles[first + 1] - angles[first]);
  return {first, std::clamp(share, 0.0f, 1.0f)};
}

struct AnglePair {
  float vertical = 0, horizontal = 0;
};

/// The inverses of LightProfile::Angles. x: side, down: aim.
AnglePair angles_of(LightProfile::Angles angles, float x, float y, float down) {
  switch (angles) {
    case LightProfile::Angles::b:
      return {std::atan2(x, down), std::atan2(-y, std::hypot(x, down))};
    case LightProfile::Angles::a:
      return {std::atan2(x, std::hypot(y, down)), std::atan2(-y, down)};
    case LightProfile::Angles::c:
      break;
  }
  const float h = std::atan2(y, x);
  return {std::atan2(std::hypot(x, y), down), h < 0 ? h + 2 * kPi : h};
}

/// Angles come out of a few operations on floats: what is beyond the border by less lies on it.
bool reaches(const std::vector<float>& angles, float angle) {
  constexpr float kRounding = 1e-6f;
  return angle >= angles.front() - kRounding && angle <= angles.back() + kRounding;
}

}  // namespace

float candela_at(const LightProfile& profile, Vec3 aim, Vec3 side, Vec3 direction) {
  const Vec3 y_axis = cross(-aim, side);
  const AnglePair at =
      angles_of(profile.angles, dot(direction, side), dot(direction, y_axis), dot(direction, aim));
  if (!reaches(profile.vertical_rad, at.vertical)) return 0;
  const GridCell v = cell_of(profile.vertical_rad, at.vertical);
  const size_t rows = profile.vertical_rad.size();
  const auto along = [&](size_t column) {
    const float* c = &profile.candela[column * rows + v.first];
    return c[0] + v.share * (c[1] - c[0]);
  };
  if (profile.horizontal_rad.size() == 1) return along(0);
  if (!reaches(profile.horizontal_rad, at.horizontal)) return 0;
  const GridCell h = cell_of(profile.horizontal_rad, at.horizontal);
  const float low = along(h.first);
  return low + h.share * (along(h.first + 1) - low);
}

double mean_candela(const LightProfile& profile, double half_angle_rad) {
  constexpr int kSteps = 512;
  const double height = 1 - std::cos(half_angle_rad);
  double sum = 0;
  for (int j = 0; j < kSteps; ++j) {
    const double down = 1 - height * (j + 0.5) / kSteps;
    const double radius = std::sqrt(std::max(0.0, 1 - down * down));
    for (int i = 0; i < kSteps; ++i) {
      const double phi = 2 * kPiDouble * (i + 0.5) / kSteps;
      const DVec3 d{radius * std::cos(phi), radius * std::sin(phi), -down};
      sum += double(candela_at(profile, {0, 0, -1}, {1, 0, 0}, to_float(d)));
    }
  }
  return sum / (double(kSteps) * kSteps);
}

void attach_profile(Scene& scene, size_t light, LightProfile profile, float scale) {
  PunctualLight& target = scene.lights[light];
  LUXEL_CHECK(can_have_profile(target.kind));
  target.direction = normalize(target.direction);
  if (target.direction == Vec3{}) target.direction = {0, -1, 0};
  const Vec3 across = target.side - target.direction * dot(target.side, target.direction);
  constexpr float kTooShort = 1e-3f;  // to tell a direction by
  target.side =
      length(across) > kTooShort ? normalize(across) : frame_around(target.direction).tangent;
  const float largest = max_component(target.intensity);
  target.intensity = (largest > 0 ? target.intensity / largest : Rgb{1, 1, 1}) * scale;
  target.profile = uint32_t(scene.profiles.size());
  scene.profiles.push_back(std::move(profile));
}

}  // namespace luxel::scene
