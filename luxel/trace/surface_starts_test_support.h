// Starts of rays on quads of many sizes, places and turns, for tracers of the processor and of
// devices.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "luxel/base/random.h"
#include "luxel/scene/off_surface.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::trace::testing {

/// A quad, instance 0, and a small copy of a part of it, instance 1, which is cut along the other
/// diagonal. Both stand once more far above, so that tracers can share their meshes.
struct QuadAndCopy {
  std::string name;
  scene::Scene scene;
  Vec2 half_of_copy;  ///< half its sides over those of the quad
};
/// The middle of the copy, over the quad's sides.
inline constexpr Vec2 kMiddleOfCopy{0.4f, 0.6f};

/// A rectangle about the origin and one of the two ways to cut it.
inline scene::Mesh quad_mesh(Vec2 side, Vec2 middle, bool other_diagonal) {
  scene::Mesh out;
  for (const Vec2 c : {Vec2{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}})
    out.positions.push_back({middle.x + c.x * side.x, middle.y + c.y * side.y, 0});
  if (other_diagonal)
    out.triangles = {{0, 1, 3}, {1, 2, 3}};
  else
    out.triangles = {{0, 1, 2}, {0, 2, 3}};
  out.triangle_material = {0, 0};
  return out;
}

/// The map that turns about a unit axis.
inline Mat34 turn(Vec3 axis, float angle_rad) {
  const auto turned = [&](Vec3 v) {
    return v * std::cos(angle_rad) + cross(axis, v) * std::sin(angle_rad) +
           axis * (dot(axis, v) * (1 - std::cos(angle_rad)));
  };
  return from_columns(turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {});
}

inline QuadAndCopy quad_and_copy(float unit_m, Vec2 side, const Mat34& turned, float away,
                                 bool placed) {
  const Vec2 side_m = side * unit_m;
  const float small_m = 0.02f * unit_m;
  QuadAndCopy out{fmt::format("unit {}, {} x {}, {} away{}", unit_m, side.x, side.y, away,
                              placed ? ", placed" : ""),
                  {},
                  {small_m / side_m.x / 2, small_m / side_m.y / 2}};
  scene::Scene& scene = out.scene;
  scene.materials.push_back({});
  const Vec2 middle{(kMiddleOfCopy.x - 0.5f) * side_m.x, (kMiddleOfCopy.y - 0.5f) * side_m.y};
  scene.meshes = {quad_mesh(side_m, {}, false), quad_mesh({small_m, small_m}, middle, true)};
  const Mat34 stands = translation(Vec3{1, -0.4f, 0.7f} * (away * unit_m)) * turned;
  if (!placed)
    for (scene::Mesh& mesh : scene.meshes)
      for (Vec3& p : mesh.positions) p = transform_point(stands, p);
  const Mat34 world = placed ? stands : Mat34{};
  const Mat34 above = translation(Vec3{0, 0, 3e4f} * unit_m) * world;
  scene.instances = {{"quad", 0, world}, {"copy", 1, world}, {"", 0, above}, {"", 1, above}};
  return out;
}

/// In units of a centimetre, a metre and a kilometre: sides from a thousandth to four thousand, and
/// a road; along the axes and turned; up to two thousand away, placed by the instance or by its
/// vertices.
inline std::vector<QuadAndCopy> quads_with_copies() {
  const Mat34 about_y = turn({0, 1, 0}, 0.53f) * turn({1, 0, 0}, -0.5f * kPi),
              oblique = turn(normalize(Vec3{1, 2, -0.7f}), 1.1f);
  std::vector<QuadAndCopy> out;
  for (const float unit_m : {1e-2f, 1.0f, 1e3f})
    for (const Vec2 side : {Vec2{1e-3f, 1e-3f}, {1, 1}, {4000, 4000}, {4000, 8}})
      for (const Mat34& turned : {Mat34{}, about_y, oblique})
        for (const float away : {0.0f, 1.0f, 40.0f, 2000.0f})
          for (const bool placed : {true, false})
            out.push_back(quad_and_copy(unit_m, side, turned, away, placed));
  return out;
}

/// Rays from 200 places of the quad, every other one where the copy lies: along it with a slope of
/// 0.02, and straight away.
inline std::vector<Ray> rays_off(const QuadAndCopy& on) {
  RandomStream random{5};
  std::vector<Ray> out;
  for (int k = 0; k < 200; ++k) {
    Vec2 u = random.next2();
    if (k % 2) {
      const Vec2 half{std::min(on.half_of_copy.x, 0.4f), std::min(on.half_of_copy.y, 0.4f)};
      u = kMiddleOfCopy + Vec2{(2 * u.x - 1) * half.x, (2 * u.y - 1) * half.y};
    }
    const bool first = u.x > u.y;
    const scene::SurfacePoint at{0, first ? 0u : 1u,
                                 first ? Barycentric{u.x - u.y, u.y} : Barycentric{u.x, u.y - u.x}};
    const Frame f = frame_around(scene::front_normal(on.scene, 0, at.triangle));
    const Vec3 from = scene::off_surface(on.scene, at, f.normal);
    const float phi = 2 * kPi * random.next();
    out.push_back({from, 0, f.to_world({std::cos(phi), std::sin(phi), 0.02f}), INFINITY});
    out.push_back({from, 0, f.normal, INFINITY});
  }
  return out;
}

}  // namespace luxel::trace::testing
