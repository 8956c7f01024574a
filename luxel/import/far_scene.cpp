#include "luxel/import/far_scene.h"

#include <cmath>

#include "luxel/base/check.h"
#include "luxel/import/readers.h"
#include "luxel/scene/held_range.h"
#include "luxel/scene/origin.h"

namespace luxel::import {
namespace {

double largest_of(DVec3 p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

DVec3 middle_of(const DBox3& box) { return (box.lower + box.upper) * 0.5; }

double size_of(const DBox3& box) { return length(box.upper - box.lower); }

DBox3 box_of(const scene::Mesh& mesh) {
  DBox3 box;
  for (const Vec3 p : mesh.positions) box.extend(to_double(p));
  return box;
}

DBox3 box_of(const ExactPlaces& exact, const scene::Scene& scene) {
  DBox3 box;
  for (size_t i = 0; i < scene.instances.size(); ++i)
    for (const Vec3 p : scene.meshes[scene.instances[i].mesh].positions)
      box.extend(transform_point(exact.instances[i], to_double(p)));
  return box;
}

/// So much rounding shows, as a part of the scene's size.
constexpr double kSeen = 1e-4;

/// Meshes whose own coordinates lie far from 0, seen in the size of the scene: rays are taken into
/// the coordinates of shared meshes. `shifts`: what was taken off each mesh.
void move_meshes(double scene_size, const std::string& file, scene::Scene& scene,
                 std::vector<DVec3>& shifts, std::vector<std::string>& told) {
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    scene::Mesh& mesh = scene.meshes[m];
    const DBox3 box = box_of(mesh);
    const auto user = std::ranges::find(scene.instances, uint32_t(m), &scene::Instance::mesh);
    if (user == scene.instances.end() || mesh.positions.empty()) continue;
    const double scale =
        std::cbrt(std::abs(double(determinant(user->world_from_object))));  // metres per unit
    const double far = largest_of(middle_of(box));
    if (!(far * scale > 8 * scene_size)) continue;
    shifts[m] = origin_for(box);
    for (Vec3& p : mesh.positions) p = to_float(to_double(p) - shifts[m]);
    if (const double step = float_step(far); step * scale > kSeen * scene_size)
      told.push_back(fmt::format(
          "{}: {} has its vertices {:.3g} m from its own origin, where single precision has steps "
          "of {:.2g} m: they are rounded to that; export it with vertices near its own origin, and "
          "the distance in its node",
          file, label("mesh", m, mesh.name), far * scale, step * scale));
  }
}

void move_to(DVec3 place, Mat34& m) {
  m.row[0][3] = float(place.x), m.row[1][3] = float(place.y), m.row[2][3] = float(place.z);
}

}  // namespace

DMat34 as_stated(const Mat34& m) {
  DMat34 out;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 4; ++j) out.row[i][j] = scene::short_number(m.row[i][j]);
  return out;
}

double float_step(double value) {
  const auto below = float(value);
  return double(std::nextafter(below, INFINITY)) - double(below);
}

DVec3 origin_for(const DBox3& box) {
  const DVec3 middle = middle_of(box);
  const double size = size_of(box);
  if (!std::isfinite(size) || !std::isfinite(largest_of(middle)) || length(middle) <= 8 * size)
    return {};
  int exponent = 0;
  std::frexp(size, &exponent);  // size < 2^exponent <= 2 size
  const double unit = std::ldexp(1.0, exponent);
  const auto nearest = [&](double v) { return unit * std::round(v / unit); };
  return {nearest(middle.x), nearest(middle.y), nearest(middle.z)};
}

// 1. A scene near its origin keeps its coordinates, to the bit. 2. The origin, from all vertices in
// double precision. 3. Meshes that lie far from their own. 4. Instances keep their linear parts and
// get translations that are small; so do lights and cameras.
std::vector<std::string> move_towards_origin(const ExactPlaces& exact,
                                             const std::optional<DVec3>& wished,
                                             const std::string& file, Imported& imported) {
  scene::Scene& scene = imported.scene;
  LUXEL_CHECK(exact.instances.size() == scene.instances.size() &&
              exact.lights.size() == scene.lights.size() &&
              exact.cameras.size() == scene.cameras.size());
  const DBox3 box = box_of(exact, scene);
  DVec3 origin = wished.value_or(origin_for(box));
  // Nothing is held there, and validation says so.
  if (largest_of(origin) > double(scene::kFarthest_m)) origin = {};
  if (origin == DVec3{} && !exact.is_relative) return {};
  std::vector<std::string> told;
  std::vector<DVec3> shifts(scene.meshes.size());
  move_meshes(size_of(box), file, scene, shifts, told);
  for (const scene::Instance& instance : scene.instances)
    imported.object_origin.push_back(shifts[instance.mesh]);
  if (exact.read_step_m > kSeen * size_of(box))
    told.push_back(fmt::format(
        "{}: nodes lie so far from the origin that the single precision in which this format is "
        "read has steps of {:.2g} m: places are rounded to that; move the scene nearer to the "
        "origin, or export it as glTF",
        file, exact.read_step_m));
  for (size_t i = 0; i < scene.instances.size(); ++i)
    move_to(transform_point(exact.instances[i], shifts[scene.instances[i].mesh]) - origin,
            scene.instances[i].world_from_object);
  for (size_t i = 0; i < scene.lights.size(); ++i)
    scene.lights[i].position = to_float(exact.lights[i] - origin);
  for (size_t i = 0; i < scene.cameras.size(); ++i)
    move_to(exact.cameras[i] - origin, scene.cameras[i].world_from_camera);
  scene.origin = origin;
  return told;
}

}  // namespace luxel::import
