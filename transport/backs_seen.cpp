#include "transport/backs_seen.h"

#include <array>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"

namespace luxel::transport {

BacksSeen backs_seen(const scene::Scene& scene, const trace::RayTracer& tracer, Vec3 from,
                     Vec3 normal, int rays) {
  constexpr size_t kMost = 64;
  LUXEL_CHECK(rays > 0 && size_t(rays) <= kMost);
  const size_t count = size_t(rays);
  const auto frame = frame_around(normal);
  std::array<trace::Ray, kMost> batch;
  std::array<trace::Hit, kMost> hits;
  for (uint32_t k = 0; k < count; ++k)
    batch[k] = {from, 0, frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 3))), INFINITY};
  tracer.closest_hits(std::span(batch).first(count), std::span(hits).first(count));
  BacksSeen seen{rays, 0, 0};
  for (const trace::Hit& hit : std::span(hits).first(count)) {
    if (!hit.found() || !hit.back_face) continue;
    const scene::Material& material = scene::material_at(scene, hit.point());
    ++(scene::reflects_from_behind(material) ? seen.double_sided : seen.one_sided);
  }
  return seen;
}

bool is_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                 const Elements& elements, size_t i, const BacksSeen& own, float diagonal_m) {
  constexpr int kRays = 64;
  const int backs = own.one_sided + own.double_sided;
  if (4 * own.one_sided < own.rays && 8 * backs < 7 * own.rays) return false;
  if (4 * own.one_sided > 3 * own.rays) return true;
  const Vec3 from =
      trace::offset_origin(elements.position[i], elements.geometric_normal[i], diagonal_m);
  return is_enclosed(backs_seen(scene, tracer, from, elements.normal[i], kRays));
}

std::vector<uint8_t> find_enclosed(const scene::Scene& scene, const trace::RayTracer& tracer,
                                   const Elements& elements,
                                   const std::function<BacksSeen(size_t)>& seen) {
  const float diagonal_m = scene::world_bounds(scene).diagonal();
  std::vector<uint8_t> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      out[i] = is_enclosed(scene, tracer, elements, i, seen(i), diagonal_m);
  });
  return out;
}

}  // namespace luxel::transport
