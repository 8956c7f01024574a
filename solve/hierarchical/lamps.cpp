#include "solve/hierarchical/lamps.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"
#include "base/warp.h"
#include "transport/direct_light.h"

namespace luxel::hierarchical {
namespace {

/// Points of a leaf at which lamps are looked for: corners of a smaller copy of it, and its middle.
constexpr double kInside = 0.6;
constexpr uint32_t kSkyRays = 64;

void add_points(const Element& e, DVec3 normal, transport::Elements& out) {
  const auto add = [&](DVec3 p) {
    out.position.push_back(to_float(p));
    out.normal.push_back(to_float(normal)), out.geometric_normal.push_back(to_float(normal));
    out.reflectance.push_back({});
  };
  for (uint32_t k = 0; k < e.corners; ++k) add(e.centre + (e.corner[k] - e.centre) * kInside);
  add(e.centre);
}

/// E of the background at each point.
std::vector<Rgb> sky_light(const Exchange& x, const transport::Elements& points, Rgb radiance) {
  std::vector<Rgb> out(points.size());
  if (max_component(radiance) == 0) return out;
  parallel_for(points.size(), 64, [&](size_t begin, size_t end) {
    std::vector<trace::Ray> rays(kSkyRays);
    std::vector<uint8_t> blocked(kSkyRays);
    for (size_t i = begin; i < end; ++i) {
      const auto frame = frame_around(points.normal[i]);
      const Vec3 from = trace::offset_origin(points.position[i], points.normal[i], x.diagonal_m);
      for (uint32_t k = 0; k < kSkyRays; ++k)
        rays[k] = {from, 0, frame.to_world(cosine_hemisphere_sample(sobol_owen_2d(k, 5)))};
      x.tracer.occluded(rays, blocked);
      const auto hidden = float(std::count(blocked.begin(), blocked.end(), 1));
      out[i] = radiance * (kPi * (1 - hidden / kSkyRays));
    }
  });
  return out;
}

}  // namespace

Lamps lamps_of(const scene::Scene& scene) {
  Lamps out;
  out.punctual.punctual = scene.lights;
  out.background = scene.background;
  return out;
}

Status light_leaves(Refined& state, const Exchange& x, const Lamps& lamps,
                    const RefineParams& params, std::vector<uint8_t>& lit, Progress& progress) {
  if (!lamps.any()) return {};
  for (;;) {
    lit.resize(state.tree.elements.size());
    std::vector<size_t> leaves;
    transport::Elements points;
    for (size_t e = 0; e < lit.size(); ++e) {
      if (lit[e] || !state.tree.elements[e].is_leaf()) continue;
      lit[e] = 1;
      leaves.push_back(e);
      const Element& element = state.tree.elements[e];
      add_points(element, x.faces.faces[element.face].plane.normal, points);
    }
    if (leaves.empty()) return {};
    LUXEL_TRY(const transport::DirectLight direct,
              transport::direct_light(state.scene, points, lamps.punctual, x.tracer, {64, 1, true},
                                      progress));
    const std::vector<Rgb> sky = sky_light(x, points, lamps.background);
    size_t k = 0;
    for (const size_t e : leaves) {
      const uint32_t count = state.tree.elements[e].corners + 1;
      Rgb sum{};
      float least = INFINITY, most = 0;
      for (const size_t end = k + count; k < end; ++k) {
        const Rgb light = direct.irradiance[k] + sky[k];
        sum += light / float(count);
        least = std::min(least, max_component(light)), most = std::max(most, max_component(light));
      }
      state.light.elements[e].lamps = sum;
      if (double(most - least) > params.eps &&
          state.tree.elements[e].area_m2 > 4 * params.min_area_m2 &&
          state.tree.elements.size() + 4 <= params.max_elements)
        divide_element(state, x, e);
    }
  }
}

}  // namespace luxel::hierarchical
