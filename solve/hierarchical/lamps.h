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

/// Sets ElementLight::unlinked of all leaves that have none yet (`lit` counts elements, in order),
/// dividing leaves over which it is farther than eps from linear. As with links, large leaves count
/// for more: see error_of.
Status light_leaves(Refined& state, const Exchange& exchange, const Lamps& lamps,
                    const RefineParams& params, std::vector<uint8_t>& lit, Progress& progress);

}  // namespace luxel::hierarchical
