#include "solve/hierarchical/enclosed.h"

#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"

namespace luxel::hierarchical {
namespace {

constexpr uint32_t kRays = 64;
/// Of the mean: a place that sees as much light is in the open.
constexpr float kDark = 0.02f;

bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                 Vec3 normal) {
  const auto frame = frame_around(normal);
  std::array<trace::Ray, kRays> rays;
  std::array<trace::Hit, kRays> hits;
  for (uint32_t k = 0; k < kRays; ++k)
    rays[k] = {from, 0, frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 3))), INFINITY};
  tracer.closest_hits(rays, hits);
  uint32_t backs = 0;
  for (const trace::Hit& hit : hits)
    backs += hit.found() && hit.back_face && !scene::material_at(scene, hit.point()).double_sided;
  return 2 * backs > kRays;
}

}  // namespace

std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   std::span<const Vec3> position, std::span<const Vec3> normal,
                                   std::span<const Rgb> irradiance) {
  double mean = 0;
  for (const Rgb& e : irradiance) mean += double(luminance(e)) / double(irradiance.size());
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<uint8_t> out(position.size());
  parallel_for(position.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out[i] = luminance(irradiance[i]) < kDark * float(mean) &&
               is_enclosed(scene, tracer, trace::offset_origin(position[i], normal[i], diagonal_m),
                           normal[i]);
  });
  return out;
}

}  // namespace luxel::hierarchical
