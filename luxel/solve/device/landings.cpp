#include "luxel/solve/device/landings.h"

#include "luxel/base/parallel.h"
#include "luxel/scene/sides.h"

namespace luxel::device {
namespace {

using on_device::Landing;

/// The hit of a ray that comes to a triangle from one side, far away.
trace::Hit hit_at(const scene::Scene& scene, uint32_t instance, uint32_t triangle,
                  bool from_behind) {
  trace::Hit out{INFINITY, instance, triangle, {}, from_behind};
  if (!from_behind) return out;
  if (const auto other = scene::other_side_of(scene, out.point()))
    out.triangle = other->triangle, out.back_face = false;
  return out;
}

Landing landing_of(const gather::RayScene& in, uint32_t instance, uint32_t triangle,
                   bool from_behind) {
  trace::Hit hit = hit_at(in.scene, instance, triangle, from_behind);
  Landing out{in.atlas.corners[in.atlas.triangle_number(instance, hit.triangle)], 0, 0};
  // The other side's u is this one's v.
  if (hit.triangle != triangle) std::swap(out.corners[1], out.corners[2]);
  if (!gather::shows_light(in, hit)) {
    out.kind = on_device::kDark;
    return out;
  }
  if (hit.back_face) out.kind |= on_device::kFromBehind;
  if (in.near == nullptr) return out;
  if (gather::map_answers(*in.near, hit) == gather::MapAnswers::no) {
    out.kind |= on_device::kFollowed;
    return out;
  }
  hit.t = 0;
  if (gather::map_answers(*in.near, hit) == gather::MapAnswers::no)
    out.near_m = gather::near_m(*in.near, hit);
  return out;
}

}  // namespace

std::vector<on_device::Landing> landings_of(const gather::RayScene& in) {
  std::vector<on_device::Landing> out(2 * in.atlas.corners.size());
  for (uint32_t i = 0; i < in.scene.instances.size(); ++i) {
    const size_t count = in.scene.meshes[in.scene.instances[i].mesh].triangles.size();
    parallel_for(count, 4096, [&](size_t begin, size_t end) {
      for (uint32_t t = uint32_t(begin); t < end; ++t) {
        on_device::Landing* const both = &out[2 * size_t(in.atlas.triangle_number(i, t))];
        both[0] = landing_of(in, i, t, false), both[1] = landing_of(in, i, t, true);
      }
    });
  }
  return out;
}

}  // namespace luxel::device
