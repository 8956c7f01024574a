#include "luxel/transport/covers.h"

#include <algorithm>
#include <array>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"

namespace luxel::transport {
namespace {

/// A cover is no higher than this part of the size. The rays that it shuts within the size itself
/// are then 1 - 0.25^2 = 94 % of the hemisphere, and more than the share below asks for.
constexpr float kHighest = 0.25f;
/// Covered places see less than this of what lies beyond.
constexpr float kOpen = 0.1f;
constexpr uint32_t kRays = 64;

}  // namespace

float open_share(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, float size_m) {
  const trace::Ray up{from, 0, normal, kHighest * size_m};
  uint8_t shut = 0;
  tracer.occluded({&up, 1}, {&shut, 1});
  if (!shut) return 1;
  std::array<trace::Ray, kRays> rays;
  std::array<uint8_t, kRays> blocked{};
  const Frame frame = frame_around(normal);
  for (uint32_t k = 0; k < kRays; ++k)
    rays[k] = {from, 0, frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 5))), size_m};
  tracer.occluded(rays, blocked);
  const float open = float(std::count(blocked.begin(), blocked.end(), 0)) / float(kRays);
  return open < kOpen ? open : 1;
}

std::vector<float> open_shares(const trace::RayTracer& tracer, const Elements& elements,
                               float size_m, float diagonal_m) {
  std::vector<float> out(elements.size());
  parallel_for(out.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 normal = elements.geometric_normal[i];
      const Vec3 from = trace::offset_origin(elements.position[i], normal, diagonal_m);
      out[i] = open_share(tracer, from, normal, size_m);
    }
  });
  return out;
}

}  // namespace luxel::transport
