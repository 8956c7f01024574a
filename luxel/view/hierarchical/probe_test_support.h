// A square lamp over a floor, a screen that hides part of it, and its light in closed form.
#pragma once

#include <cmath>

#include "luxel/solve/hierarchical/hierarchical_test_support.h"
#include "luxel/solve/hierarchical/represent.h"
#include "luxel/view/hierarchical/pick.h"

namespace luxel::view::testing {

/// hierarchical::testing::lamp_and_screen(): the floor is y = 0, the lamp at 2.5 m is as wide as
/// this to both sides, the screen at 1 m ends at x = 0.25 m.
inline constexpr float kLampHalf_m = 0.1f, kLampRadiance = 10;
inline constexpr double kLampHeight_m = 2.5, kScreenEdge_m = 0.25;

/// Solved, with its light mesh. It stays where it was made.
struct Lamp {
  std::unique_ptr<hierarchical::testing::Solved> solved;
  hierarchical::LightMesh mesh;
  SolutionView view() const { return {solved->scene, *solved->tracer, solved->solution, &mesh}; }
};

inline const Lamp& lamp() {
  static const Lamp made = [] {
    Lamp out;
    out.solved = hierarchical::testing::solved(
        hierarchical::testing::lamp_and_screen(kLampHalf_m, kLampRadiance));
    Progress progress;
    out.mesh = *hierarchical::make_light_mesh(out.solved->solution, out.solved->scene,
                                              *out.solved->tracer, {}, progress);
    return out;
  }();
  return made;
}

/// The number of the face of an instance of one face.
inline uint32_t face_of(const SolutionView& view, uint32_t instance) {
  const hierarchical::Faces& faces = view.solution.faces;
  return faces.face_of_triangle[faces.first_triangle[instance]];
}
inline constexpr uint32_t kFloor = 0, kLampFace = 1, kScreen = 2;  ///< instances

/// The form factor to a rectangle of the lamp's plane from a point of the floor, [Lambert1760]:
/// half of the sum over its edges of the angle each is seen under times the cosine between the
/// floor's normal and that of the plane through the edge and the point, over pi.
inline double factor_of_rectangle(double x, double z, double x0, double x1, double z0, double z1) {
  if (!(x1 > x0)) return 0;
  const std::array<std::array<double, 2>, 4> corner{{{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}}};
  double sum = 0;
  for (size_t k = 0; k < 4; ++k) {
    const double ax = corner[k][0] - x, az = corner[k][1] - z;
    const double bx = corner[(k + 1) % 4][0] - x, bz = corner[(k + 1) % 4][1] - z;
    const double y = kLampHeight_m;
    const double dot = ax * bx + y * y + az * bz;
    const double cx = y * bz - az * y, cy = az * bx - ax * bz, cz = ax * y - y * bx;
    const double size = std::sqrt(cx * cx + cy * cy + cz * cz);
    sum += std::atan2(size, dot) * cy / size;
  }
  return std::abs(sum) / (2 * M_PI);
}

/// E at a point of the floor near its middle line: the screen hides what of the lamp is left of
/// where the ray past its edge arrives.
inline double light_at(double x, double z) {
  const double half = double(kLampHalf_m), edge = x + (kScreenEdge_m - x) * kLampHeight_m;
  const double from = std::max(-half, std::min(half, edge));
  return M_PI * double(kLampRadiance) * factor_of_rectangle(x, z, from, half, -half, half);
}

/// Looks down on the floor at x = 0.5 m, 100 pixels a metre there.
inline scene::Camera scene_camera_above() {
  scene::Camera camera;
  camera.world_from_camera.row[0] = {1, 0, 0, 0.5f};
  camera.world_from_camera.row[1] = {0, 0, 1, 2};
  camera.world_from_camera.row[2] = {0, -1, 0, 0};
  camera.fov_y_rad = 2 * std::atan(0.5f), camera.aspect = 1;
  return camera;
}
inline trace::CameraRays camera_above() {
  return trace::CameraRays(scene_camera_above(), 200, 200);
}

}  // namespace luxel::view::testing
