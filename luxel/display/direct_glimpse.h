// Surfaces that lie in the light: a quick look, for choosing views. For this room only.
#pragma once

#include <span>
#include <vector>

#include "luxel/scene/scene.h"
#include "luxel/trace/ray_tracer.h"

namespace luxel::display {

/// A point of a surface on the side that a ray came to, and the unit normal of that side.
struct SeenSide {
  Vec3 at, normal;
};
/// The side that a ray's hit lies on.
SeenSide side_seen_by(const scene::Scene& scene, const trace::Ray& ray, const trace::Hit& hit);

/// The lights of a scene as points and directions: all, or some hundred that stand for more.
struct Glimpse {
  struct Source {
    Vec3 at{};  ///< a point, or the direction towards a sun
    bool is_direction = false;
    Vec3 normal{};  ///< of an emissive surface, which shines to its front; else zero
  };
  std::vector<Source> sources;
  bool has_surroundings = false;
};
Glimpse glimpse_of(const scene::Scene& scene);

/// For each hit, as seen by the ray that made it, whether light of a source arrives at its side of
/// the surface without a bounce. Ranges and cones of lights are not looked at.
std::vector<uint8_t> lit_by_sources(const scene::Scene& scene, const trace::RayTracer& tracer,
                                    const Glimpse& glimpse, std::span<const trace::Ray> rays,
                                    std::span<const trace::Hit> hits);
/// 1 for each hit that light of the surroundings reaches, by a few rays from it.
std::vector<uint8_t> lit_by_surroundings(const scene::Scene& scene, const trace::RayTracer& tracer,
                                         const Glimpse& glimpse, std::span<const trace::Ray> rays,
                                         std::span<const trace::Hit> hits);

}  // namespace luxel::display
