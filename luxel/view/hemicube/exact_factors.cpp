// Form factors from an element to every triangle of the scene, past all others, in closed form.
#include <algorithm>
#include <numeric>

#include "luxel/view/hemicube/vertex_report.h"
#include "luxel/viewfactor/point_visibility.h"

namespace luxel::view {
namespace {

/// Every triangle may stand before every other: 4 million pairs take about a second.
constexpr size_t kMostExactTriangles = 2000;
/// A hemisphere and rounding.
constexpr double kMostSum = 1.001;

viewfactor::Polygon polygon_of(const scene::Scene& scene, uint32_t instance, uint32_t triangle) {
  scene::Triangle3 t = scene::world_triangle(scene, instance, triangle);
  // Counter-clockwise from the front.
  if (determinant(scene.instances[instance].world_from_object) < 0) std::swap(t.b, t.c);
  return {to_double(t.a), to_double(t.b), to_double(t.c)};
}

/// The half of space that an element sees: above its own triangle, and on its normal's side.
struct Horizon {
  DVec3 from, normal;
  std::array<Plane, 2> planes;

  viewfactor::Polygon above(viewfactor::Polygon polygon, double slack_m) const {
    for (const Plane& plane : planes) {
      if (polygon.empty()) break;
      polygon = viewfactor::clip_above(polygon, plane, slack_m);
    }
    return polygon;
  }
};

Horizon horizon_of(const LightMesh& mesh, uint32_t element) {
  const transport::Elements& e = mesh.receivers.elements;
  const DVec3 from = to_double(e.position[element]);
  const DVec3 normal = normalize(to_double(e.normal[element]));
  const DVec3 facet = normalize(to_double(e.geometric_normal[element]));
  return {from, normal, {{{normal, dot(normal, from)}, {facet, dot(facet, from)}}}};
}

/// A triangle as far as it is seen, and its number.
struct Visible {
  viewfactor::Polygon polygon;
  uint32_t number = 0;
  bool has_two_sides = false;
};

/// Those above the horizon. Small parts of wide triangles below it may stay, which cover nothing.
std::vector<Visible> triangles_above(const scene::Scene& scene, const Horizon& horizon,
                                     double slack_m) {
  std::vector<Visible> out;
  uint32_t number = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t, ++number) {
      viewfactor::Polygon above = horizon.above(polygon_of(scene, i, t), slack_m);
      if (above.size() < 3) continue;
      const scene::Material& material = scene.materials[mesh.triangle_material[t]];
      out.push_back({std::move(above), number, scene::reflects_from_behind(material)});
    }
  }
  return out;
}

bool lets_light_through(const scene::Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const scene::Material& m) { return scene::lets_light_through(m); });
}

}  // namespace

Result<std::optional<std::vector<double>>> exact_factors(const LightMesh& mesh, uint32_t element,
                                                         Progress& progress) {
  const scene::Scene& scene = mesh.in->scene;
  if (lets_light_through(scene)) return std::nullopt;
  const double slack_m = 1e-9 * double(scene::world_bounds(scene).diagonal());
  const Horizon horizon = horizon_of(mesh, element);
  const std::vector<Visible> all = triangles_above(scene, horizon, slack_m);
  if (all.size() > kMostExactTriangles) return std::nullopt;
  progress.begin("exact form factors", all.size());
  std::vector<viewfactor::Blocker> blockers;
  for (const Visible& one : all) blockers.push_back(viewfactor::make_blocker(one.polygon));
  std::vector<uint8_t> casts(all.size());
  viewfactor::VisibilityScratch scratch;
  std::vector<double> out(mesh.mesh.first_triangle.back());
  std::vector<uint32_t> others;
  for (uint32_t i = 0; i < all.size(); ++i) {
    LUXEL_TRY_STATUS(stopped(progress));
    viewfactor::Polygon polygon = all[i].polygon;
    const double facing = blockers[i].plane.height(horizon.from);
    if (blockers[i].area_m2 <= 0 || (facing <= 0 && !all[i].has_two_sides)) continue;
    if (facing < 0) std::reverse(polygon.begin(), polygon.end());
    others.clear();
    for (uint32_t k = 0; k < all.size(); ++k)
      if (k != i && blockers[k].area_m2 > 0) others.push_back(k);
    out[all[i].number] =
        viewfactor::visible_point_factor(horizon.from, horizon.normal, polygon, {blockers, others},
                                         slack_m, casts, scratch)
            .visible;
    progress.advance(1);
  }
  // Surfaces that coincide are each seen whole.
  const double sum = std::accumulate(out.begin(), out.end(), 0.0);
  return sum > kMostSum ? std::nullopt : std::optional(std::move(out));
}

}  // namespace luxel::view
