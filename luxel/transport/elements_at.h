// Elements at chosen points of surfaces.
#pragma once

#include "luxel/transport/elements.h"

namespace luxel::transport {

/// One element per point, in their order, on its front: smooth_point(). Reflectances are left out.
Elements elements_at(const scene::Scene& scene, std::span<const scene::SurfacePoint> points);

}  // namespace luxel::transport
