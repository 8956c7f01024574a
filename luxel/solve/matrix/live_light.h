// Direct light of punctual lights that move: one shadow ray per point and light.
#pragma once

#include <span>

#include "luxel/base/vec.h"
#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::matrix {

/// Surface points that lights shine on.
struct LitPoints {
  std::span<const Vec3> position;          ///< where rays start [m], as in transport::Elements
  std::span<const Vec3> normal;            ///< unit, for the cosine
  std::span<const Vec3> geometric_normal;  ///< unit, the side that is lit
  size_t size() const { return position.size(); }
};

/// E [W/m^2] at a surface point from point, spot and directional lights; a sun's disc counts as its
/// centre. Light profiles are not looked at.
Rgb live_light_at(const LitPoints& points, size_t place,
                  std::span<const scene::PunctualLight> lights, const trace::RayTracer& tracer);

/// E [W/m^2] at every point, in parallel. Allocates nothing.
void live_light(const LitPoints& points, std::span<const scene::PunctualLight> lights,
                const trace::RayTracer& tracer, std::span<Rgb> irradiance);

}  // namespace luxel::matrix
