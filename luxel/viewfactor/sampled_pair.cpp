// View factors of single polygons by rays, for comparison with formulas.
#include <array>
#include <cmath>

#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/shapes.h"
#include "luxel/viewfactor/sampled_factors.h"
#include "luxel/viewfactor/surface_sampler.h"

namespace luxel::viewfactor {
namespace {

void place_polygon(scene::Scene& scene, std::string name, PolygonView polygon) {
  scene::Mesh mesh;
  mesh.name = std::move(name);
  for (size_t i = 2; i < polygon.size(); ++i)
    scene::add_triangle(mesh, to_float(polygon[0]), to_float(polygon[i - 1]), to_float(polygon[i]),
                        0);
  scene::place(scene, std::move(mesh));
}

}  // namespace

scene::Scene scene_of_polygons(PolygonView a, PolygonView b, std::span<const Polygon> blockers) {
  scene::Scene scene;
  scene::add_material(scene, "gray", {0.5f, 0.5f, 0.5f});
  if (!a.empty()) place_polygon(scene, "a", a);
  place_polygon(scene, "b", b);
  for (const Polygon& blocker : blockers) place_polygon(scene, "blocker", blocker);
  return scene;
}

Result<SampledFactor> sampled_form_factor(PolygonView a, PolygonView b,
                                          std::span<const Polygon> blockers,
                                          const SampledParams& params) {
  const scene::Scene scene = scene_of_polygons(a, b, blockers);
  Progress progress;
  LUXEL_TRY(const Surfaces surfaces, surfaces_of(scene, progress));
  const uint32_t from = surfaces.of_instance[0], to = surfaces.of_instance[1];
  if (from == scene::kNone || to == scene::kNone) return SampledFactor{};
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  LUXEL_TRY(const FactorMatrix matrix,
            sampled_factors(scene, surfaces, tracer, params, {.from = from}, progress));
  return SampledFactor{matrix.at(from, to), matrix.error[from * matrix.size() + to]};
}

Result<SampledFactor> sampled_point_factor(DVec3 point, DVec3 normal, PolygonView b,
                                           std::span<const Polygon> blockers,
                                           const SampledParams& params) {
  const scene::Scene scene = scene_of_polygons({}, b, blockers);
  Progress progress;
  LUXEL_TRY(const Surfaces surfaces, surfaces_of(scene, progress));
  const uint32_t to = surfaces.of_instance[0];
  if (to == scene::kNone) return SampledFactor{};
  LUXEL_TRY(const trace::RayTracer tracer, trace::RayTracer::build(scene));
  const Vec3 up = to_float(normalize(normal));
  if (params.hemicube > 0) {
    std::vector<double> sums(surfaces.surfaces.size());
    const float turn = 2 * kPi * unit_float(uint32_t(hash64(params.seed)));
    LUXEL_TRY(const Hemicube cube, make_hemicube(params.hemicube, progress));
    add_hemicube_factors(surfaces, tracer, cube, {to_float(point), 0, up, INFINITY}, turn, sums,
                         progress);
    return SampledFactor{sums[to],
                         standard_error_of_share(sums[to], double(cube.direction.size()))};
  }
  uint32_t count = 0;
  for (uint32_t k = 0; k < params.samples; ++k) {
    const Vec3 local = cosine_hemisphere_sample(sobol_owen_2d(k, params.seed));
    const trace::Hit hit =
        tracer.closest_hit({to_float(point), 0, frame_around(up).to_world(local), INFINITY});
    count += hit.found() && !hit.back_face && surfaces.of_instance[hit.instance] == to;
  }
  const double share = double(count) / params.samples;
  return SampledFactor{share, standard_error_of_share(share, params.samples)};
}

}  // namespace luxel::viewfactor
