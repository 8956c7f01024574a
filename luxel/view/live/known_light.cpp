#include "luxel/view/live/known_light.h"

#include <algorithm>
#include <cmath>

#include "luxel/view/edit/drawn_edits.h"

namespace luxel::view {
namespace {

/// Rays that an estimate traces.
constexpr double kRaysOfEstimates = 400'000;
// Seconds per triangle that is sorted and per instance of a top level, as in a city of 54,000
// triangles; and by how much more a ray takes through two levels, which is a guess.
constexpr double kSort_s = 1e-6, kInstance_s = 3e-6, kTwoLevels_s = 1e-7;

float area_of(const scene::Scene& scene) {
  double sum = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const size_t triangles = scene.meshes[scene.instances[i].mesh].triangles.size();
    for (uint32_t t = 0; t < triangles; ++t)
      sum += double(scene::area_m2(scene::world_triangle(scene, i, t)));
  }
  return float(sum);
}

}  // namespace

bool flat_is_quicker(const scene::Scene& scene, double rays) {
  const double flat = kSort_s * double(scene::first_triangles(scene).back());
  return flat < kInstance_s * double(scene.instances.size()) + kTwoLevels_s * rays;
}

Result<std::shared_ptr<KnownLight>> known_light(const light::TexelScene& in,
                                                const scene::Scene& as_read) {
  auto out = std::make_shared<KnownLight>();
  out->scene = in.scene, out->atlas = in.atlas, out->map = in.map;
  out->is_apart = !flat_is_quicker(in.scene, kRaysOfEstimates);
  LUXEL_TRY(trace::RayTracer tracer, out->is_apart ? trace::RayTracer::build_apart(out->scene)
                                                   : trace::RayTracer::build(out->scene));
  out->tracer.emplace(std::move(tracer));
  out->material_as_read = materials_as_read(as_read, in.scene, {});
  out->position = copied(in.elements.position);
  out->normal = copied(in.elements.geometric_normal);
  out->texel_m2 = area_of(in.scene) / float(std::max<size_t>(in.map.texels.size(), 1));
  return out;
}

}  // namespace luxel::view
