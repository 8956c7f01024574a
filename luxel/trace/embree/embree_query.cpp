#include "luxel/trace/embree/embree_query.h"

#include <bit>

#include "luxel/base/random.h"

namespace luxel::trace {
namespace {

/// A number in [0, 1) that follows from the bits of a ray and of what it meets.
float chance_of(const RTCFilterFunctionNArguments* args, unsigned i, uint64_t place) {
  const auto bits = [](float x) { return uint64_t(std::bit_cast<uint32_t>(x)); };
  RTCRayN* ray = args->ray;
  const uint64_t direction =
      hash64(bits(RTCRayN_dir_x(ray, args->N, i)) << 32 | bits(RTCRayN_dir_y(ray, args->N, i)),
             bits(RTCRayN_dir_z(ray, args->N, i)));
  const uint64_t origin =
      hash64(bits(RTCRayN_org_x(ray, args->N, i)) << 32 | bits(RTCRayN_org_y(ray, args->N, i)),
             bits(RTCRayN_org_z(ray, args->N, i)));
  return unit_float(uint32_t(hash64(hash64(direction, origin), place) >> 32));
}

}  // namespace

void let_through(const RTCFilterFunctionNArguments* args) {
  Query& query = *reinterpret_cast<Query*>(args->context);
  const scene::Scene& scene = query.scene;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const scene::SurfacePoint p{
        instance_of(RTCHitN_instID(args->hit, args->N, i, 0),
                    RTCHitN_geomID(args->hit, args->N, i)),
        RTCHitN_primID(args->hit, args->N, i),
        {RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i)}};
    const scene::Passage passage = scene::passage_at(scene, p);
    if (passage.coverage >= 1) continue;
    if (query.through == Through::none) {
      if (passage.coverage <= 0) args->valid[i] = 0;
      continue;
    }
    const uint64_t place = uint64_t(p.instance) << 32 | p.triangle;
    if (query.through == Through::chance) {
      if (chance_of(args, i, place) >= passage.coverage) args->valid[i] = 0;
      continue;
    }
    const unsigned lane = RTCRayN_id(args->ray, args->N, i);
    // Where packets are taken apart Embree may ask for lanes that no ray is in.
    if (lane >= query.light.size()) continue;
    Rgb& light = query.light[lane];
    if (query.is_new(lane, place)) {
      const float open = query.through == Through::share ? 1 - passage.coverage : 1.0f;
      light = light * passage.tint * open;
    }
    if (max_component(light) > 0) args->valid[i] = 0;
  }
}

}  // namespace luxel::trace
