#include "luxel/solve/hierarchical/enclosed.h"

#include "luxel/base/parallel.h"
#include "luxel/transport/back_faces.h"

namespace luxel::hierarchical {
namespace {

/// Rays per point. A share of one half is known to within 1 / (2 sqrt 64) = 6 %.
constexpr int kRays = 64;
/// A point with more light than this part of the mean is in the open: no rays are needed to tell.
/// Larger asks rays of more points; with 0 a solid into which a little light leaks would not be
/// found.
constexpr float kDark = 0.02f;

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
               is_hidden(transport::count_back_faces(
                   scene, tracer, trace::offset_origin(position[i], normal[i], diagonal_m),
                   normal[i], kRays));
  });
  return out;
}

}  // namespace luxel::hierarchical
