#include "luxel/scene/off_surface.h"

#include "luxel/scene/both_off_surface.h"

namespace luxel::scene {
namespace {

float largest(Vec3 v) { return max_component(max(v, -v)); }

}  // namespace

float size_for_rounding(const Mat34& world_from_object, Vec3 extent_m, Vec3 n) {
  return std::max({largest(column(world_from_object, 3)), 4 * dot(max(n, -n), extent_m),
                   max_component(extent_m) / 8});
}

float rounding_m(Vec3 position, float size_m) { return both::rounding_m(position, size_m); }

Vec3 off_surface(Vec3 position, Vec3 normal, float size_m) {
  return position + normal * rounding_m(position, size_m);
}

Vec3 off_surface(const Facet& facet, Barycentric at, Vec3 normal) {
  const Triangle3& t = facet.corners;
  return off_surface(interpolate(t.a, t.b, t.c, at), normal, facet.size_m);
}

Vec3 off_surface(const Scene& scene, const SurfacePoint& p, Vec3 normal) {
  return off_surface(facet_of(scene, p.instance, p.triangle), p.at, normal);
}

}  // namespace luxel::scene
