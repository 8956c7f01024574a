#include "luxel/viewfactor/surfaces.h"

#include <fmt/format.h>

#include <map>

#include "luxel/viewfactor/merge_polygons.h"

namespace luxel::viewfactor {
namespace {

DVec3 world_point(const Mat34& m, Vec3 p) {
  const auto coordinate = [&](size_t i) {
    const auto& r = m.row[i];
    return double(r[0]) * p.x + double(r[1]) * p.y + double(r[2]) * p.z + double(r[3]);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

/// Names given so far, and the last number that each was given.
using Names = std::map<std::string, int>;

/// The instance's name, made different from those before it.
std::string unique_name(const scene::Scene& scene, uint32_t instance, Names& names) {
  std::string name = scene.instances[instance].name;
  if (name.empty()) name = scene.meshes[scene.instances[instance].mesh].name;
  if (name.empty()) name = fmt::format("surface {}", instance + 1);
  std::string candidate = name;
  while (!names.try_emplace(candidate, 1).second)
    candidate = fmt::format("{}#{}", name, ++names[name]);
  return candidate;
}

}  // namespace

double corner_rounding_m(const scene::Scene& scene) {
  const Box3 bounds = scene::world_bounds(scene);
  if (bounds.empty()) return 0;
  double largest = 0;
  for (const Vec3 p : {bounds.lower, bounds.upper})
    largest = std::max(largest, double(max_component(max(p, -p))));
  return 4 * 0x1p-23 * largest;
}

std::vector<std::array<DVec3, 3>> world_triangles(const scene::Scene& scene, uint32_t instance) {
  const scene::Instance& placed = scene.instances[instance];
  const scene::Mesh& mesh = scene.meshes[placed.mesh];
  const bool mirrors = determinant(placed.world_from_object) < 0;
  std::vector<std::array<DVec3, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& corners : mesh.triangles) {
    std::array<DVec3, 3> t;
    for (size_t k = 0; k < 3; ++k)
      t[k] = world_point(placed.world_from_object, mesh.positions[corners[k]]);
    if (mirrors) std::swap(t[1], t[2]);
    triangles.push_back(t);
  }
  return triangles;
}

Result<Surfaces> surfaces_of(const scene::Scene& scene, Progress& progress) {
  progress.begin("join polygons", scene::first_triangles(scene).back());
  Surfaces out;
  out.of_instance.assign(scene.instances.size(), scene::kNone);
  out.slack_m = corner_rounding_m(scene);
  if (out.slack_m == 0) return out;
  Names names;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    Surface surface{unique_name(scene, i, names), i, {}, 0};
    LUXEL_TRY(MergedPolygons merged,
              merge_polygons(world_triangles(scene, i), out.slack_m, progress));
    surface.polygons = std::move(merged.polygons);
    for (const Polygon& polygon : surface.polygons) surface.area_m2 += area_m2(polygon);
    if (!(surface.area_m2 > 0)) {
      out.warnings.push_back(fmt::format("surface '{}' has no area and is left out", surface.name));
      continue;
    }
    out.of_instance[i] = uint32_t(out.surfaces.size());
    out.surfaces.push_back(std::move(surface));
  }
  return out;
}

}  // namespace luxel::viewfactor
