#include "luxel/transport/elements_at.h"

#include "luxel/base/parallel.h"

namespace luxel::transport {

Elements elements_at(const scene::Scene& scene, std::span<const scene::SurfacePoint> points) {
  Elements e;
  e.position.resize(points.size()), e.normal.resize(points.size());
  e.geometric_normal.resize(points.size());
  parallel_for(points.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const SmoothPoint at = smooth_point(scene, points[i]);
      e.position[i] = at.start, e.normal[i] = at.normal;
      e.geometric_normal[i] = at.geometric_normal;
    }
  });
  return e;
}

}  // namespace luxel::transport
