// Light that comes from no surface: lamps without area, the background.
#pragma once

#include "solve/hierarchical/refine.h"
#include "transport/lights.h"

namespace luxel::hierarchical {

/// What shines besides surfaces.
struct Lamps {
  transport::Lights punctual;  ///< no triangles
  Rgb background{};            ///< radiance
  bool any() const { return !punctual.punctual.empty() || max_component(background) > 0; }
};
Lamps lamps_of(const scene::Scene& scene);

/// The share of the sky that a point sees, weighted by the cosine about `normal`: by so many rays,
/// the same directions everywhere.
float visible_sky(const trace::RayTracer& tracer, Vec3 position, Vec3 normal, Vec3 geometric_normal,
                  float diagonal_m, uint32_t count);

/// Sets ElementLight::unlinked of all leaves that have none yet (`lit` counts elements, in order),
/// dividing leaves over which it is farther than eps from linear. As with links, large leaves count
/// for more: see error_of.
Status light_leaves(Refined& state, const Exchange& exchange, const Lamps& lamps,
                    const RefineParams& params, std::vector<uint8_t>& lit, Progress& progress);

}  // namespace luxel::hierarchical
