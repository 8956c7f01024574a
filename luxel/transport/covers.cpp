#include "luxel/transport/covers.h"

#include <algorithm>
#include <array>

#include "luxel/base/parallel.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"

namespace luxel::transport {
namespace {

/// A cover is no higher than this part of the size.
constexpr float kHighest = 0.25f;
/// Rays leave the gap at so many times its height: covers need not be quite even.
constexpr float kAbove = 1.5f;
/// Rays less steep than this stay in the gap, whatever its width: 1 / 16^2 = 0.4 % of them.
constexpr float kSteep = 1.0f / 16;
/// Covered places see less than this of what lies beyond.
constexpr float kOpen = 0.1f;
constexpr uint32_t kRays = 64;

}  // namespace

float open_share(const trace::RayTracer& tracer, Vec3 from, Vec3 normal, float size_m) {
  const trace::Hit above = tracer.closest_hit({from, 0, normal, kHighest * size_m});
  if (!above.found()) return 1;
  std::array<trace::Ray, kRays> rays;
  std::array<uint8_t, kRays> blocked{};
  const Frame frame = frame_around(normal);
  for (uint32_t k = 0; k < kRays; ++k) {
    const Vec3 d = cosine_hemisphere_sample(sobol_owen_2d(k, 5));
    rays[k] = {from, 0, frame.to_world(d), kAbove * above.t / std::max(d.z, kSteep)};
  }
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
