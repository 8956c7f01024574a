#include "luxel/viewfactor/surface_sampler.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/base/random.h"
#include "luxel/base/warp.h"
#include "luxel/scene/off_surface.h"

namespace luxel::viewfactor {
namespace {

uint32_t reversed_24(uint32_t x) {
  uint32_t out = 0;
  for (int bit = 0; bit < 24; ++bit) out |= ((x >> bit) & 1u) << (23 - bit);
  return out;
}

}  // namespace

SurfaceSampler make_surface_sampler(const scene::Scene& scene, uint32_t instance) {
  SurfaceSampler sampler;
  const size_t count = scene.meshes[scene.instances[instance].mesh].triangles.size();
  double sum = 0;
  for (uint32_t t = 0; t < count; ++t) {
    sampler.triangles.push_back(scene::facet_of(scene, instance, t));
    sampler.area_below.push_back(sum);
    sum += double(scene::area_m2(sampler.triangles.back().corners));
  }
  sampler.area_below.push_back(sum);
  return sampler;
}

SurfaceSample sample_surface(const SurfaceSampler& sampler, Vec2 u) {
  const std::vector<double>& below = sampler.area_below;
  const double at = double(u.x) * below.back();
  const auto next = std::upper_bound(below.begin(), below.end() - 1, at);
  const size_t t = size_t(next - below.begin()) - 1;
  // The remainder of u.x after the choice is uniform again.
  const double rest = (at - below[t]) / (below[t + 1] - below[t]);
  const float x = float(std::clamp(rest, 0.0, 0x1.fffffep-1));
  const scene::Facet& triangle = sampler.triangles[t];
  return {scene::off_surface(triangle, triangle_sample({x, u.y}), triangle.front), triangle.front};
}

FourNumbers stratified_4d(uint32_t index, uint64_t seed) {
  LUXEL_CHECK(index < (1u << 24));
  // Owen's scrambling of the index itself: a permutation in which each bit depends only on higher
  // ones, so that aligned blocks of indices become aligned blocks, with all their strata
  // [Burley20, section 5]. The first Sobol coordinate of a point is its index with the bits
  // reversed, scrambled; from the reversed index it is what is wanted.
  const float scrambled = sobol_owen_2d(reversed_24(index), hash64(seed, 2)).x;
  const uint32_t shuffled = uint32_t(scrambled * 0x1p24f);
  return {sobol_owen_2d(index, hash64(seed, 0)), sobol_owen_2d(shuffled, hash64(seed, 1))};
}

}  // namespace luxel::viewfactor
